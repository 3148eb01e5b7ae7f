//! Cohesion: touching surfaces hold each other.

use crate::effects::{Effect, Entry, Error};
use scene::{FillingLibrary, Scene};

/// A constant attraction of every touching pair of spheres, walls included.
pub(crate) const EFFECT: Effect = Effect {
    name: "cohesion",
    physics: "Moisture or a tacky coat holds touching seeds together. The bed then moves \
              in slabs: the angle rises and swings more, most at low speed.",
    formula: "F_n = F_repulsive - Bo m g; the amplitude is the granular Bond number Bo",
    unit: "1",
    source: "Castellanos2005",
    range: [0.0, 3.0],
    probe: 0.6,
    entry: Entry::Contact,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    scene.model.bond_number += amplitude;
    Ok(())
}
