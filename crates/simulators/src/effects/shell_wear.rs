//! Wear of the shell: its friction changes over the session.

use crate::effects::{
    Effect, Entry, Error,
    session_drift::session_of,
    walls::{Part, scale_friction},
};
use scene::{FillingLibrary, Scene};

/// Friction at the shell that changes in proportion to the time since the session began.
pub(crate) const EFFECT: Effect = Effect {
    name: "shell-wear",
    physics: "Seeds polish the shell, or leave dust and coat on it: its friction at the end \
              of a session is not that of its start, while the seeds among themselves are as \
              before.",
    formula: "mu_shell = (1 + amplitude x session) x declared coefficient of static friction; \
              session is 0 at the start and 1 at the end",
    unit: "1",
    source: "Archard1953",
    range: [-0.9, 1.0],
    probe: 0.5,
    entry: Entry::Wall,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    let name = EFFECT.name;
    let factor = 1.0 + amplitude * session_of(scene, name)?;
    scale_friction(scene, Part::Shell, factor, name)
}

#[cfg(test)]
mod tests {
    use crate::effects::apply;
    use crate::effects::tests::{friction_at, small_drum};
    use scene::FillingLibrary;

    /// A quarter more of 0.33 at the shell in the middle of the session; cover and seeds as before.
    /// Rounding only.
    #[test]
    fn friction_of_the_shell_alone_changes_with_the_session() {
        let mut scene = small_drum();
        apply(&mut scene, "shell-wear", 0.5, &FillingLibrary::default()).unwrap();
        let [shell, cover, seeds] = friction_at(&scene);
        assert!((shell - 1.25 * 0.33).abs() < 1e-15, "{shell}");
        assert_eq!([cover, seeds], [0.29, 0.10]);
    }
}
