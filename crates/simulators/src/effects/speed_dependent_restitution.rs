//! Restitution that falls with the speed: the dissipation of viscoelastic seeds.

use crate::effects::{Effect, Entry, Error};
use scene::{FillingLibrary, Scene};

/// Viscoelastic damping in every contact.
pub(crate) const EFFECT: Effect = Effect {
    name: "speed-dependent-restitution",
    physics: "A drop test measures the restitution at 1 m/s and more; in a drum seeds meet at \
              a tenth of it. The dashpot of the model gives the same restitution at both, a \
              viscoelastic seed rebounds better from the slower contact.",
    formula: "c_n (1 + share ((d/d_0)^(1/4) - 1)), d_0 the overlap of a contact at 1 m/s; the \
              amplitude is the share, 1 for a wholly viscoelastic seed",
    unit: "1",
    source: "Brilliantov1996",
    range: [0.0, 1.0],
    probe: 0.8,
    entry: Entry::Contact,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    for contact in scene.contact.values_mut() {
        let share = contact.viscoelastic_damping.unwrap_or(0.0) + amplitude;
        contact.viscoelastic_damping = Some(share.min(1.0));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::effects::{apply, tests::small_drum};
    use scene::FillingLibrary;

    /// Half of the damping is viscoelastic in every contact; more adds up to the whole and not beyond.
    #[test]
    fn every_contact_becomes_viscoelastic() {
        let (mut scene, fillings) = (small_drum(), FillingLibrary::default());
        apply(&mut scene, "speed-dependent-restitution", 0.5, &fillings).unwrap();
        let contact = &scene.contact["seed-seed"];
        assert_eq!(contact.viscoelastic_damping, Some(0.5), "first");
        apply(&mut scene, "speed-dependent-restitution", 0.8, &fillings).unwrap();
        assert!(
            scene
                .contact
                .values()
                .all(|c| c.viscoelastic_damping == Some(1.0))
        );
    }
}
