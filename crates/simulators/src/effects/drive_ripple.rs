//! Ripple of the drive: the speed swings about its mean.

use crate::effects::{Effect, Entry, Error, walls::drum_of};
use scene::{FillingLibrary, Ripple, Scene};

/// Swings in one revolution of the drum where the scene states none.
const CYCLES: f64 = 6.0;

/// A speed that swings six times in a revolution.
pub(crate) const EFFECT: Effect = Effect {
    name: "drive-ripple",
    physics: "An eccentric roller or a toothed belt speeds the drum up and slows it down \
              at each of its own turns. The mean speed is right, but the bed is rocked: \
              avalanches start earlier and the angle fluctuates more.",
    formula: "speed(t) = set speed x (1 + amplitude sin(6 w t)), w the set speed in \
              rad/s: rollers of a sixth of the drum",
    unit: "1",
    source: "Mellmann2001",
    range: [0.0, 1.0],
    probe: 0.3,
    entry: Entry::Drive,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    let drum = drum_of(scene, EFFECT.name)?;
    let declared = drum.ripple.unwrap_or(Ripple {
        share: 0.0,
        cycles: CYCLES,
    });
    let share = declared.share + amplitude;
    drum.ripple = Some(Ripple { share, ..declared });
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::effects::{apply, tests::small_drum};
    use scene::{Apparatus, FillingLibrary};

    /// Shares add up, the number of swings stays, the mean speed stays; more than the whole speed is
    /// refused.
    #[test]
    fn ripple_is_added_to_that_of_the_scene() {
        let (mut scene, fillings) = (small_drum(), FillingLibrary::default());
        for amplitude in [0.25, 0.5] {
            apply(&mut scene, "drive-ripple", amplitude, &fillings).unwrap();
        }
        let Apparatus::Drum(drum) = &scene.apparatus else {
            panic!("no drum");
        };
        let ripple = drum.ripple.unwrap();
        assert_eq!((ripple.share, ripple.cycles), (0.75, super::CYCLES));
        assert_eq!(scene.apparatus.speed(), small_drum().apparatus.speed());
        let error = apply(&mut scene, "drive-ripple", 0.5, &fillings).unwrap_err();
        assert!(error.to_string().contains("1.25"), "{error}");
    }
}
