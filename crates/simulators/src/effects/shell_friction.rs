//! Friction of the shell: other than declared.

use crate::effects::{
    Effect, Entry, Error,
    walls::{Part, scale_friction},
};
use scene::{FillingLibrary, Scene};

/// Friction of the seeds at the shell, as a share of what the scene states.
pub(crate) const EFFECT: Effect = Effect {
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
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    scale_friction(scene, Part::Shell, 1.0 + amplitude, EFFECT.name)
}

#[cfg(test)]
mod tests {
    use crate::effects::apply;
    use crate::effects::tests::{friction_at, small_drum};
    use scene::FillingLibrary;

    /// Half as much again of 0.33 at the shell, and 0.29 as before at the cover. Rounding only.
    #[test]
    fn friction_of_the_shell_alone_rises_by_the_share() {
        let mut scene = small_drum();
        apply(
            &mut scene,
            "shell-friction",
            0.5,
            &FillingLibrary::default(),
        )
        .unwrap();
        let [shell, cover, seeds] = friction_at(&scene);
        assert!((shell - 1.5 * 0.33).abs() < 1e-15, "{shell}");
        assert_eq!([cover, seeds], [0.29, 0.10]);
    }
}
