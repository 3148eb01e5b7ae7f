//! Tilt of the drum axis: the rig does not stand level.

use crate::effects::{Effect, Entry, Error, refused, walls::drum_of};
use input::quantity::Angle;
use scene::{FillingLibrary, Scene};

/// A drum whose axis is not level.
pub(crate) const EFFECT: Effect = Effect {
    name: "axis-tilt",
    physics: "A rig on a bench that is not level has one end lower. Seeds gather at that \
              end, the bed is deeper there and shallower at the other, and the camera \
              sees the outline of the deep end.",
    formula: "gravity = g (0, -cos tilt, sin tilt); positive when the end that faces the \
              camera is lower",
    unit: "deg",
    source: "CottonStudy",
    range: [-5.0, 5.0],
    probe: 3.0,
    entry: Entry::Drive,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    let name = EFFECT.name;
    let drum = drum_of(scene, name)?;
    let tilt = drum.tilt.map_or(0.0, Angle::si) + amplitude.to_radians();
    drum.tilt = Some(Angle::from_si(tilt).map_err(|e| refused(name, &e))?);
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::effects::{apply, tests::small_drum};
    use scene::{Apparatus, FillingLibrary, run};

    /// Tilts add up, and the unit is degrees.
    #[test]
    fn the_tilt_is_added() {
        let (mut scene, fillings) = (small_drum(), FillingLibrary::default());
        for amplitude in [5.0, -2.0] {
            apply(&mut scene, "axis-tilt", amplitude, &fillings).unwrap();
        }
        let Apparatus::Drum(drum) = &scene.apparatus else {
            panic!("no drum");
        };
        let tilt = drum.tilt.unwrap().si().to_degrees();
        assert!((tilt - 3.0).abs() < 1e-12, "{tilt}");
    }

    /// The same seeds gather at the end that is lower: towards the camera (+z) for a positive tilt.
    /// A level bed of the same starts lies between the two.
    #[test]
    fn seeds_gather_at_the_lower_end() {
        let fillings = FillingLibrary::default();
        let [back, level, front] = [-5.0, 0.0, 5.0].map(|tilt| {
            let mut scene = small_drum();
            apply(&mut scene, "axis-tilt", tilt, &fillings).unwrap();
            let result = run(&scene, &fillings, 5).unwrap();
            let z = result
                .frames
                .iter()
                .flat_map(|f| f.position.iter().map(|p| p.z));
            z.sum::<f64>() / (result.frames.len() * result.n_bodies) as f64
        });
        assert!(back < level && level < front, "{back} {level} {front} m");
    }
}
