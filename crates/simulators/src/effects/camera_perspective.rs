//! Camera perspective: front and back edge of the bed are not seen at one size.

use crate::effects::{Effect, Entry, Error, refused, walls::drum_of};
use input::quantity::Length;
use scene::{FillingLibrary, Scene};

/// A camera near the drum, on its axis.
pub(crate) const EFFECT: Effect = Effect {
    name: "camera-perspective",
    physics: "A camera near the drum sees the back of the bed smaller than the front, \
              drawn towards the axis. Below the axis the back edge stands above the front \
              edge, so the outline is that of the back: the surface seems nearer to the \
              axis, and a curved surface flatter. A flat one keeps its angle while the \
              camera is on the axis.",
    formula: "size in the picture = D/(D + depth behind the front cover), D = \
              R/amplitude, R the inner radius of the drum",
    unit: "1",
    source: "HartleyZisserman2004",
    range: [0.0, 0.5],
    probe: 0.25,
    entry: Entry::Camera,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    let name = EFFECT.name;
    let radius = 0.5 * drum_of(scene, name)?.inner_diameter.si();
    let declared = scene.camera.distance.map_or(0.0, |d| radius / d.si());
    let distance = Length::from_si(radius / (declared + amplitude));
    scene.camera.distance = Some(distance.map_err(|e| refused(name, &e))?);
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::effects::{apply, tests::small_drum};
    use scene::FillingLibrary;

    /// Radius over distance is the amplitude, and adds to that of the scene. Rounding only.
    #[test]
    fn the_camera_stands_at_the_radius_over_the_amplitude() {
        let (mut scene, fillings) = (small_drum(), FillingLibrary::default());
        for expected in [0.2, 0.4] {
            apply(&mut scene, "camera-perspective", 0.2, &fillings).unwrap();
            let ratio = 0.035 / scene.camera.distance.unwrap().si();
            assert!((ratio - expected).abs() < 1e-12, "{ratio}");
        }
    }
}
