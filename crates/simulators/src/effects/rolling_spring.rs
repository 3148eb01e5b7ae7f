//! Rolling resistance of type C: a spring that yields, so that a seed at rest feels no torque.

use crate::effects::rolling_resistance::raise_rolling_friction;
use crate::effects::{Effect, Entry, Error, refused};
use scene::{FillingLibrary, RollingLaw, Scene};

/// Rolling resistance of type C in every contact.
pub(crate) const EFFECT: Effect = Effect {
    name: "rolling-spring",
    physics: "Facets and dents hold a seed in its place until the torque passes a limit: \
              elastic before, plastic after. Unlike the constant torque it carries a heap \
              at rest, so that it acts on slow beds more than on fast ones.",
    formula: "k_r = 2.25 k_t L^2, |M| <= mu_r F_n L; the amplitude is added to mu_r of every \
              contact, and all rolling resistance becomes of this type",
    unit: "1",
    source: "Ai2011",
    range: [0.0, 0.5],
    probe: 0.1,
    entry: Entry::Contact,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    if scene.model.rolling_law == RollingLaw::SpringDashpot {
        let reason = "the rolling resistance of the scene is of this type already, so that more of it is rolling-resistance";
        return Err(refused(EFFECT.name, &reason));
    }
    scene.model.rolling_law = RollingLaw::SpringDashpot;
    raise_rolling_friction(scene, amplitude, EFFECT.name)
}

#[cfg(test)]
mod tests {
    use crate::effects::{apply, tests::small_drum};
    use scene::FillingLibrary;

    /// Where the declared law is type C already, this effect would be a copy of rolling-resistance, and each would always tie
    /// with the other.
    #[test]
    fn more_of_a_declared_spring_is_another_effect() {
        let (mut scene, fillings) = (small_drum(), FillingLibrary::default());
        scene.model.rolling_law = scene::RollingLaw::SpringDashpot;
        let error = apply(&mut scene, "rolling-spring", 0.2, &fillings).unwrap_err();
        assert!(error.to_string().contains("rolling-resistance"), "{error}");
    }

    /// Every contact of the study, which has no rolling friction, gets the coefficient, and the law is type C.
    #[test]
    fn every_contact_rolls_on_a_spring() {
        let (mut scene, fillings) = (small_drum(), FillingLibrary::default());
        apply(&mut scene, "rolling-spring", 0.2, &fillings).unwrap();
        assert_eq!(scene.model.rolling_law, scene::RollingLaw::SpringDashpot);
        assert!(
            scene
                .contact
                .values()
                .all(|c| c.rolling_friction.get() == 0.2)
        );
    }
}
