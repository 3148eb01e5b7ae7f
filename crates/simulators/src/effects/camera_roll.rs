//! Camera roll: the camera is turned about its axis, and nobody knows.

use crate::effects::{Effect, Entry, Error};
use input::quantity::Angle;
use scene::{FillingLibrary, Scene};

/// A turn of the camera about its optical axis.
pub(crate) const EFFECT: Effect = Effect {
    name: "camera-roll",
    physics: "A camera that is not level adds its own angle to every angle that is read \
              from its pictures, whatever the bed does.",
    formula: "angle in the picture = angle of the bed + roll",
    unit: "deg",
    source: "CottonStudy",
    range: [-3.0, 3.0],
    probe: 3.0,
    entry: Entry::Camera,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    let roll = scene.camera.roll.si() + amplitude.to_radians();
    scene.camera.roll = Angle::from_si(roll).map_err(|e| Error::Setting {
        name: EFFECT.name,
        reason: e.to_string(),
    })?;
    Ok(())
}
