//! Sliding friction that changes with the speed of sliding.

use crate::{Description, Effect, Entry, Error};
use scene::{FillingLibrary, Scene};

/// Rate-dependent friction in every contact.
#[derive(Debug)]
pub(crate) struct RateDependentFriction;

impl Effect for RateDependentFriction {
    fn description(&self) -> Description {
        Description {
            name: "rate-dependent-friction",
            physics: "A slider or a tilted plate gives the friction at rest. In the flowing layer seeds \
                      slide at some 50 mm/s, where many surfaces hold less, and some coats more.",
            formula: "mu (1 + b v/(v + 50 mm/s)); the amplitude is b, negative for weakening",
            unit: "1",
            source: "Marone1998",
            range: [-0.8, 2.0],
            probe: 0.5,
            entry: Entry::Contact,
        }
    }

    fn apply(&self, scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
        for contact in scene.contact.values_mut() {
            contact.friction_rate = Some(contact.friction_rate.unwrap_or(0.0) + amplitude);
        }
        Ok(())
    }
}
