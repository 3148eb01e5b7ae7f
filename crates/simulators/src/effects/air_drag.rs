//! Air drag: the air slows flowing seeds.

use crate::effects::{Effect, Entry, Error};
use scene::{FillingLibrary, Scene};

/// Drag of still air on every seed.
pub(crate) const EFFECT: Effect = Effect {
    name: "air-drag",
    physics: "Air slows seeds that move through it. For dense seeds of some millimetres \
              at the speeds of a drum it is small; fibres and hollow or feathery seeds \
              feel it. The air is taken as still; in a drum it turns with the covers in \
              part.",
    formula: "F = -amplitude (pi/8) rho d^2 C v |v|, C = 24/Re (1 + 0.15 Re^0.687), d of \
              the sphere with the volume of the seed",
    unit: "1",
    source: "SchillerNaumann1933",
    range: [0.0, 20.0],
    probe: 5.0,
    entry: Entry::Body,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    let drag = scene.surroundings.air_drag.unwrap_or(0.0) + amplitude;
    scene.surroundings.air_drag = Some(drag);
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::effects::{apply, tests::small_drum};
    use scene::FillingLibrary;

    /// The amplitude adds to the drag of the scene; nothing else acts. What the drag does to a falling
    /// seed is tested where the force is, in crate `scene`.
    #[test]
    fn the_amplitude_is_the_multiple_of_the_drag_of_a_sphere() {
        let (mut scene, fillings) = (small_drum(), FillingLibrary::default());
        for expected in [5.0, 10.0] {
            apply(&mut scene, "air-drag", 5.0, &fillings).unwrap();
            assert_eq!(scene.surroundings.air_drag, Some(expected));
        }
        assert!(scene.surroundings.charge_nc.is_none() && scene.surroundings.vibration.is_none());
    }
}
