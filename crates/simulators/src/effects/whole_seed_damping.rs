//! Damping of the whole seed: a dashpot that stops the seed, not the sphere that touches.

use crate::effects::{Effect, Entry, Error};
use scene::{FillingLibrary, Scene};

/// The dashpots of spheres take the mass of their seed.
pub(crate) const EFFECT: Effect = Effect {
    name: "whole-seed-damping",
    physics: "A seed that hits with one of its spheres is stopped by the dashpot of that sphere. If this knows the mass of \
              the sphere alone, as in a bonded agglomerate, it takes a small part of the energy of the seed, which rebounds \
              too high. What a contact dissipates is set by the mass that its impulse moves: with it the coefficient of \
              restitution holds for the normal velocity at the point of contact. The formula of the dashpot returns the \
              restitution put in only if it may pull at the end of the contact, so the pull is let in as well.",
    formula: "c_n = 2 sqrt(5/6) b sqrt(k m), sqrt(m) = (1 - a) sqrt(m_sphere) + a sqrt(M), 1/M = 1/m_seed + (r x n) I^-1 (r x \
              n) for one contact at r, shared among several of the same two bodies; a is the amplitude, and the share of the \
              pull",
    unit: "1",
    source: "Berry2023",
    range: [0.0, 1.0],
    probe: 0.5,
    entry: Entry::Contact,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    let model = &mut scene.model;
    model.whole_seed_damping = (model.whole_seed_damping + amplitude).min(1.0);
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::effects::{apply, tests::small_drum};
    use scene::{FillingLibrary, Override};

    /// Shares add up to the whole and not beyond; beside dashpots that have the mass of the seed already there is nothing to add.
    #[test]
    fn shares_add_up_to_the_whole() {
        let (mut scene, fillings) = (small_drum(), FillingLibrary::default());
        for expected in [0.75, 1.0] {
            apply(&mut scene, "whole-seed-damping", 0.75, &fillings).unwrap();
            assert_eq!(scene.model.whole_seed_damping, expected);
        }
        let shared = Override {
            name: "model.dashpot_mass".into(),
            value: "shared".into(),
        };
        let mut scene = small_drum().with(&[shared]).unwrap();
        let refused = apply(&mut scene, "whole-seed-damping", 0.5, &fillings);
        let refused = refused.unwrap_err().to_string();
        assert!(refused.contains("model.dashpot_mass"), "{refused}");
    }
}
