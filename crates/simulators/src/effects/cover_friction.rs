//! Friction of the covers: other than declared.

use crate::effects::{
    Effect, Entry, Error,
    walls::{Part, scale_friction},
};
use scene::{FillingLibrary, Scene};

/// Friction of the seeds at both covers, as a share of what the scene states.
pub(crate) const EFFECT: Effect = Effect {
    name: "cover-friction",
    physics: "The end covers hold back the seeds beside them, and a narrow drum feels \
              that through its whole width. Their friction is often taken from another \
              surface than the one in the drum, or changed by dust, wear and cleaning.",
    formula: "mu_cover = (1 + amplitude) x declared coefficient of static friction",
    unit: "1",
    source: "CottonStudy",
    range: [-0.9, 3.0],
    probe: 0.5,
    entry: Entry::Wall,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    scale_friction(scene, Part::Cover, 1.0 + amplitude, EFFECT.name)
}

#[cfg(test)]
mod tests {
    use crate::effects::apply;
    use crate::effects::tests::{friction_at, small_drum};
    use scene::FillingLibrary;

    /// Half as much again of 0.29 at the cover, and 0.33 as before at the shell. Rounding only.
    #[test]
    fn friction_of_the_cover_alone_rises_by_the_share() {
        let mut scene = small_drum();
        apply(
            &mut scene,
            "cover-friction",
            0.5,
            &FillingLibrary::default(),
        )
        .unwrap();
        let [shell, cover, seeds] = friction_at(&scene);
        assert!((cover - 1.5 * 0.29).abs() < 1e-15, "{cover}");
        assert_eq!([shell, seeds], [0.33, 0.10]);
    }
}
