//! Sliding friction that changes with the speed of sliding.

use crate::effects::{Effect, Entry, Error};
use scene::{FillingLibrary, Scene};

/// Rate-dependent friction in every contact.
pub(crate) const EFFECT: Effect = Effect {
    name: "rate-dependent-friction",
    physics: "A slider or a tilted plate gives the friction at rest. In the flowing layer seeds \
              slide at some 50 mm/s, where many surfaces hold less, and some coats more.",
    formula: "mu_s (1 + change v/(v + 50 mm/s)); the amplitude is the change, negative for weakening",
    unit: "1",
    source: "Marone1998",
    range: [-0.8, 2.0],
    probe: 0.5,
    entry: Entry::Contact,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    for contact in scene.contact.values_mut() {
        contact.friction_rate = Some(contact.friction_rate.unwrap_or(0.0) + amplitude);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::effects::{apply, tests::small_drum};
    use scene::FillingLibrary;

    /// The change of friction adds to the one that is there, in every contact: 0.3 - 0.5.
    #[test]
    fn the_changes_add_up_in_every_contact() {
        let (mut scene, fillings) = (small_drum(), FillingLibrary::default());
        apply(&mut scene, "rate-dependent-friction", 0.3, &fillings).unwrap();
        apply(&mut scene, "rate-dependent-friction", -0.5, &fillings).unwrap();
        assert!(
            scene
                .contact
                .values()
                .all(|c| c.friction_rate == Some(-0.2))
        );
    }
}
