//! Slip of the drive: the drum turns slower than it was set.

use crate::effects::{Effect, Entry, Error, refused};
use input::quantity::AngularSpeed;
use scene::{FillingLibrary, Scene};

/// A speed below the one that was set.
pub(crate) const EFFECT: Effect = Effect {
    name: "drive-slip",
    physics: "A drum on rollers or a belt slips under load, and the set speed is that of \
              the motor. The real speed is lower, and so are the Froude number, the \
              curvature of the surface and the angle.",
    formula: "speed = (1 - amplitude) x set speed; Froude number = (1 - amplitude)^2 x \
              nominal",
    unit: "1",
    source: "Mellmann2001",
    range: [0.0, 0.5],
    probe: 0.2,
    entry: Entry::Drive,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    let speed = AngularSpeed::from_si(scene.apparatus.speed() * (1.0 - amplitude))
        .map_err(|e| refused(EFFECT.name, &e))?;
    scene.apparatus.set_speed(speed);
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::effects::{apply, tests::small_drum};
    use scene::FillingLibrary;

    /// A fifth slower, hence 0.64 of the Froude number. Rounding only.
    #[test]
    fn the_drum_turns_slower_by_the_share() {
        let mut scene = small_drum();
        apply(&mut scene, "drive-slip", 0.2, &FillingLibrary::default()).unwrap();
        let [slow, set] = [&scene, &small_drum()].map(|s| s.apparatus.clone());
        assert!((slow.speed() / set.speed() - 0.8).abs() < 1e-12);
        let froude = slow.froude_number(9.81) / set.froude_number(9.81);
        assert!((froude - 0.64).abs() < 1e-12, "{froude}");
    }
}
