//! Whether seeds are driven by the rolling friction that should stop them.

use crate::build::Built;
use crate::motion::rest_energy;
use crate::{RollingLaw, Scene};

/// Steps that are looked at: enough for a pile of a few seeds.
const STEPS: usize = 8;

/// Whether the torque of rolling friction of type A holds a bed in motion at the end of a run.
///
/// The torque has its full size however slowly a seed rolls. Where it changes the spin by more than twice that spin within a step, the
/// seed turns the other way after it, as fast or faster: the contact has given energy instead of taking it.
///
/// # Formula
///
/// Over some further steps: at least half of the kinetic energy, which is above that of [seeds at rest](rest_energy), is the spin of
/// seeds whose spin w changes in the step by |w| or more. In a motion that the step resolves the spin changes by a small part of it.
pub(crate) fn is_driven_by_rolling(scene: &Scene, built: &Built) -> bool {
    let rolls = scene
        .contact
        .values()
        .any(|contact| contact.rolling_friction.get() > 0.0);
    if !rolls || scene.model.rolling_law != RollingLaw::ConstantTorque || built.bonds.is_some() {
        return false;
    }
    // The bed itself stays where it is: a run that is looked at ends with the same bits.
    let mut world = built.world.clone();
    let (mut all, mut reversed) = (0.0, 0.0);
    for _ in 0..STEPS {
        let before = world.bodies().clone();
        all += world.kinetic_energy();
        if world.step().is_err() {
            return false;
        }
        let after = world.bodies();
        for (i, spin) in before.spin.iter().enumerate() {
            if (after.spin[i] - spin).norm() >= spin.norm() {
                reversed += 0.5 * before.angular_momentum[i].dot(spin);
            }
        }
    }
    let rest = rest_energy(scene, &built.world) * STEPS as f64;
    all > rest && reversed >= 0.5 * all
}

#[cfg(test)]
mod tests {
    use super::is_driven_by_rolling;
    use crate::build::build;
    use crate::motion::{advance, rest_energy};
    use crate::{Doubt, Ending, FillingLibrary, Override, Scene, run};
    use std::path::Path;

    /// Peas in a cylinder that is not lifted, with an attraction of 20 weights.
    const SCENE: &str = r#"
        [apparatus]
        kind = "heap"
        inner_diameter = "20 mm"
        height = "40 mm"
        lift_speed = "50 mm/s"
        floor = "wall"
        cylinder = "wall"
        [[seed]]
        name = "pea"
        sphere = "4 mm"
        density = "1250 kg/m3"
        count = 30
        material = "pea"
        [material]
        pea = { poisson_ratio = 0.3, shear_modulus = "2 MPa" }
        wall = { poisson_ratio = 0.3, shear_modulus = "1 GPa" }
        [contact]
        pea-pea = { restitution = 0.3, static_friction = 0.6, rolling_friction = 0.3, attraction_n = 0.008 }
        pea-wall = { restitution = 0.3, static_friction = 0.2, rolling_friction = 0.1 }
    "#;

    fn scene(changes: &[(&str, &str)]) -> Scene {
        let changes: Vec<_> = changes
            .iter()
            .map(|(name, value)| Override {
                name: (*name).into(),
                value: (*value).into(),
            })
            .collect();
        Scene::from_text(SCENE, "peas.toml", Path::new("."), &changes).expect("a scene")
    }

    /// Whether peas are driven after 0.3 s, and their kinetic energy over that at rest; with the step of the scene, or another (s).
    fn after_a_while(scene: &Scene, step: Option<f64>) -> (bool, f64) {
        let mut built = build(scene, &FillingLibrary::default(), 1).expect("built");
        if let Some(step) = step {
            built.world.set_time_step(step).expect("a step");
        }
        advance(scene, &mut built, 0.3).expect("believable");
        let driven = is_driven_by_rolling(scene, &built);
        let rest = rest_energy(scene, &built.world);
        (driven, built.world.kinetic_energy() / rest)
    }

    /// With the step of dry peas the torques turn the peas to and fro for ever, and that is found; with the step of the scene they rest
    /// after the same time. The other law needs no shorter step, and dry peas are not driven.
    #[test]
    fn sticky_peas_rest_with_the_step_of_the_scene_and_not_with_that_of_dry_ones() {
        let (sticky, dry) = (scene(&[]), scene(&[("contact.pea-pea.attraction_n", "0")]));
        let mut built = build(&dry, &FillingLibrary::default(), 1).expect("built");
        let long = built.world.settings().time_step;
        built = build(&sticky, &FillingLibrary::default(), 1).expect("built");
        let short = built.world.settings().time_step;
        assert!(short < 0.2 * long, "{short} s, dry {long} s");
        let (driven, energy) = after_a_while(&sticky, Some(long));
        assert!(driven && energy > 1.0, "{driven}, {energy}");
        let (driven, energy) = after_a_while(&sticky, None);
        assert!(!driven && energy < 1.0, "{driven}, {energy}");
        let spring = scene(&[("model.rolling_law", "spring-dashpot")]);
        let (driven, _) = after_a_while(&spring, Some(long));
        assert!(!driven, "the other law");
        let (driven, energy) = after_a_while(&dry, None);
        assert!(!driven && energy < 1.0, "{driven}, {energy}");
    }

    /// A heap whose dry seeds hinder each other's rolling ten times as much as their weight could turn them never rests, and
    /// the run says why and what to change.
    #[test]
    fn a_run_that_ends_with_driven_seeds_says_so() {
        let rough = [
            ("contact.pea-pea.attraction_n", "0"),
            ("contact.pea-pea.rolling_friction", "10"),
            ("contact.pea-wall.rolling_friction", "10"),
            ("apparatus.lift_speed", "200 mm/s"),
            ("protocol.rotation_limit", "0.4 s"),
        ];
        let heap = scene(&rough);
        let result = run(&heap, &FillingLibrary::default(), 1).expect("runs");
        assert_eq!(result.ending, Ending::Rested(Some(Doubt::DrivenByRolling)));
        let words = result.ending.doubt().expect("a doubt").words();
        assert!(words.contains("protocol.step_share") && words.contains("spring-dashpot"));
        let spring = scene(&[&rough[..], &[("model.rolling_law", "spring-dashpot")]].concat());
        let result = run(&spring, &FillingLibrary::default(), 1).expect("runs");
        assert_ne!(result.ending, Ending::Rested(Some(Doubt::DrivenByRolling)));
    }
}
