//! Number of seeds: other than counted.

use crate::effects::{Effect, Entry, Error};
use scene::{FillingLibrary, Scene};

/// More or fewer seeds in the drum than the scene states.
pub(crate) const EFFECT: Effect = Effect {
    name: "seed-count",
    physics: "Seeds are counted or weighed in; some are lost, some stay from the run \
              before. The filling of the drum changes, and with it the angle and the \
              depth of the flowing layer.",
    formula: "number of seeds = (1 + amplitude) x counted, rounded; the shares of the \
              kinds stay",
    unit: "1",
    source: "Mellmann2001",
    range: [-0.2, 0.2],
    probe: 0.1,
    entry: Entry::Body,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    let exact = (scene.seed_count() as f64 * (1.0 + amplitude)).round();
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a count times 0.8 to 1.2"
    )]
    scene.set_seed_count((exact as usize).max(1));
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::effects::{apply, tests::small_drum};
    use scene::FillingLibrary;

    #[test]
    fn the_count_changes_by_the_share() {
        for (amplitude, expected) in [(0.1, 44), (-0.2, 32)] {
            let mut scene = small_drum();
            apply(
                &mut scene,
                "seed-count",
                amplitude,
                &FillingLibrary::default(),
            )
            .unwrap();
            assert_eq!(scene.seed_count(), expected);
        }
    }
}
