//! Vibration of the rig: the motor shakes it.

use crate::effects::{Effect, Entry, Error, refused};
use input::quantity::{Frequency, Length};
use scene::{FillingLibrary, Scene, VibrationSettings};

/// Frequency of the mains, Hz, where the scene states no frequency.
const MAINS: f64 = 50.0;

/// A vertical vibration of an apparatus that a motor turns, at the frequency of the mains.
pub(crate) const EFFECT: Effect = Effect {
    name: "rig-vibration",
    physics: "A motor or a bearing shakes the rig that it turns. Shaken contacts slip \
              below their friction limit, and the bed settles at a lower angle; near one \
              gravity seeds begin to hop. A heap or a bench test has no motor and stays \
              at rest, unless its scene states a vibration.",
    formula: "acceleration of the rig = amplitude x g sin(2 pi f t), upward, with f = 50 \
              Hz",
    unit: "g",
    source: "Jaeger1996",
    range: [0.0, 2.0],
    probe: 0.5,
    entry: Entry::Drive,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    if scene.apparatus.speed() == 0.0 && scene.surroundings.vibration.is_none() {
        let reason =
            "no motor turns the apparatus; state surroundings.vibration where something shakes it";
        return Err(refused(EFFECT.name, &reason));
    }
    let out_of_range = |e: input::quantity::Error| refused(EFFECT.name, &e);
    let declared = match scene.surroundings.vibration.take() {
        Some(vibration) => vibration,
        None => VibrationSettings {
            amplitude: [Length::from_si(0.0).map_err(out_of_range)?; 3],
            frequency: Frequency::from_si(MAINS).map_err(out_of_range)?,
        },
    };
    let w = std::f64::consts::TAU * declared.frequency.si();
    if w == 0.0 {
        let reason = "the vibration of the scene has a frequency of 0; state one above 0 Hz";
        return Err(refused(EFFECT.name, &reason));
    }
    let [x, y, z] = declared.amplitude;
    let raised = y.si() + amplitude * scene.model.gravity_m_s2 / (w * w);
    scene.surroundings.vibration = Some(VibrationSettings {
        amplitude: [x, Length::from_si(raised).map_err(out_of_range)?, z],
        ..declared
    });
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::effects::{apply, tests::small_drum};
    use dev_support::fixture_files::fixture;
    use scene::{FillingLibrary, Scene};

    /// A heap feels nothing of the motor of a drum, but what its own scene states.
    #[test]
    fn what_no_motor_turns_is_shaken_only_where_its_scene_says_so() {
        let fillings = FillingLibrary::default();
        let heap = fixture("other-code/heap.toml");
        let mut scene = Scene::read(&heap, &[]).unwrap();
        let error = apply(&mut scene, "rig-vibration", 0.5, &fillings).unwrap_err();
        assert!(error.to_string().contains("no motor"), "{error}");
        let drum = fixture("other-code/drum.toml");
        let mut shaken = Scene::read(&drum, &[]).unwrap();
        apply(&mut shaken, "rig-vibration", 0.5, &fillings).unwrap();
        scene.surroundings = shaken.surroundings;
        apply(&mut scene, "rig-vibration", 0.5, &fillings).unwrap();
    }

    /// The peak acceleration A (2 pi f)^2 is the amplitude times gravity, upward only, and adds to that
    /// of the scene. Rounding only.
    #[test]
    fn the_peak_acceleration_is_the_amplitude() {
        let (mut scene, fillings) = (small_drum(), FillingLibrary::default());
        for expected in [0.5, 1.0] {
            apply(&mut scene, "rig-vibration", 0.5, &fillings).unwrap();
            let vibration = scene.surroundings.vibration.as_ref().unwrap();
            let w = std::f64::consts::TAU * vibration.frequency.si();
            let [x, y, z] = vibration.amplitude.map(|a| a.si() * w * w / 9.81);
            assert!((y - expected).abs() < 1e-12, "{y} g");
            assert_eq!([x, z], [0.0; 2]);
        }
    }
}
