//! Friction of one part of the drum: other than declared.

use crate::effects::{
    Effect, Entry, Error,
    walls::{Part, scale_friction},
};
use scene::{FillingLibrary, Scene};

/// Friction of the seeds at the shell, as a share of the declared one.
pub(crate) const SHELL: Effect = Effect {
    name: "shell-friction",
    physics: "The shell drives the bed. With a smoother shell than the declared one the \
              bed slides or sits lower; a rougher one lifts it until the angle no longer \
              depends on the wall.",
    formula: "mu_shell = (1 + amplitude) x declared coefficient of static friction",
    unit: "1",
    source: "CottonStudy",
    range: [-0.9, 3.0],
    probe: 0.5,
    entry: Entry::Wall,
    apply: apply_to_shell,
};

/// Friction of the seeds at both covers, as a share of the declared one.
pub(crate) const COVER: Effect = Effect {
    name: "cover-friction",
    physics: "The end covers hold back the seeds beside them, and a narrow drum feels \
              that through its whole width. Their friction is often taken from another \
              surface than the one in the drum, or changed by dust, wear and cleaning.",
    formula: "mu_cover = (1 + amplitude) x declared coefficient of static friction",
    apply: apply_to_cover,
    ..SHELL
};

fn apply_to_shell(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    scale_friction(scene, Part::Shell, 1.0 + amplitude, SHELL.name)
}

fn apply_to_cover(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    scale_friction(scene, Part::Cover, 1.0 + amplitude, COVER.name)
}

#[cfg(test)]
mod tests {
    use crate::effects::apply;
    use crate::effects::tests::{friction_at, small_drum};
    use scene::FillingLibrary;

    /// Half as much again of 0.33 at the shell or of 0.29 at the cover, and the other as before. Rounding only.
    #[test]
    fn friction_of_one_part_alone_rises_by_the_share() {
        for (name, expected) in [
            ("shell-friction", [1.5 * 0.33, 0.29, 0.10]),
            ("cover-friction", [0.33, 1.5 * 0.29, 0.10]),
        ] {
            let mut scene = small_drum();
            apply(&mut scene, name, 0.5, &FillingLibrary::default()).unwrap();
            for (found, expected) in friction_at(&scene).into_iter().zip(expected) {
                assert!((found - expected).abs() < 1e-15, "{name}: {found}");
            }
        }
    }
}
