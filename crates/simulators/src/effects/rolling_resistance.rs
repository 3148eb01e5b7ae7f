//! Rolling resistance: a torque against the rolling of one seed on another or on a wall.

use crate::effects::{Effect, Entry, Error, refused};
use input::quantity::FrictionCoefficient;
use scene::{FillingLibrary, Scene};

/// Rolling friction of type A, added to every contact of the scene.
pub(crate) const EFFECT: Effect = Effect {
    name: "rolling-resistance",
    physics: "Real seeds touch over a patch, not at a point: soft coats and small facets \
              resist rolling. A rigid agglomerate of hard spheres lacks this resistance.",
    formula: "T = -mu_r F_n L w/|w|; the amplitude is added to mu_r of every contact",
    unit: "1",
    source: "Ai2011",
    range: [0.0, 0.5],
    probe: 0.1,
    entry: Entry::Contact,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    raise_rolling_friction(scene, amplitude, EFFECT.name)
}

/// Adds an amplitude to the rolling friction of every contact, for the effect of a name.
pub(crate) fn raise_rolling_friction(
    scene: &mut Scene,
    amplitude: f64,
    name: &'static str,
) -> Result<(), Error> {
    for contact in scene.contact.values_mut() {
        let raised = contact.rolling_friction.get() + amplitude;
        contact.rolling_friction =
            FrictionCoefficient::new(raised).map_err(|e| refused(name, &e))?;
    }
    Ok(())
}
