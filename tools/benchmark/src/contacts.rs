//! Contact laws of the plain spheres, from the materials of the scene file.

use contact_law::{
    EffectiveModuli, Material, NormalForceEnd, PairParameters, material::effective_moduli,
};
use dem_solver::{Interaction, InteractionSettings};
use scene::{Apparatus, Scene};

/// The seed material against seeds, shell and cover, in this order.
#[derive(Debug, Clone)]
pub(crate) struct Contacts {
    /// Materials of seed, shell and cover.
    pub(crate) materials: [Material; 3],
    /// Restitution and friction of the seed material against each.
    pub(crate) parameters: [PairParameters; 3],
    /// What happens when the dashpot would pull.
    end: NormalForceEnd,
}

impl Contacts {
    /// Takes the contacts of the first kind of seed of a drum scene.
    pub(crate) fn of(scene: &Scene) -> anyhow::Result<Self> {
        let (Apparatus::Drum(drum), Some(seed)) = (&scene.apparatus, scene.seed.first()) else {
            anyhow::bail!("{}: the benchmark needs a drum with seeds", scene.file);
        };
        let names = [&seed.material, &drum.shell, &drum.cover];
        let material = |name: &String| scene.material[name].constants();
        let parameters = |name: &String| {
            let contact = scene.contact_of(&seed.material, name);
            let contact = contact.ok_or_else(|| {
                anyhow::anyhow!("{}: no contact {}-{name}", scene.file, seed.material)
            })?;
            anyhow::Ok(PairParameters {
                restitution: contact.restitution.get(),
                static_friction: contact.static_friction.get(),
                // The peers' laws of rolling differ, so spheres roll freely in all codes.
                rolling_friction: 0.0,
            })
        };
        let [a, b, c] = names;
        Ok(Self {
            materials: [material(a)?, material(b)?, material(c)?],
            parameters: [parameters(a)?, parameters(b)?, parameters(c)?],
            end: scene.model.normal_force_end,
        })
    }

    /// Refuses a law that the decks of the peers do not state.
    pub(crate) fn check_for_peers(&self, scene: &str) -> anyhow::Result<()> {
        anyhow::ensure!(
            self.end == NormalForceEnd::Clipped,
            "{scene}: model.normal_force_end is not \"clipped\", but LIGGGHTS and LAMMPS are asked to clip: \
             set it so beside the peers"
        );
        Ok(())
    }

    /// Effective moduli of the seed material against each.
    pub(crate) fn moduli(&self) -> [EffectiveModuli; 3] {
        let [seed, shell, cover] = &self.materials;
        [seed, shell, cover].map(|other| effective_moduli(seed, other))
    }

    /// The table of interactions, row by row; walls never meet.
    pub(crate) fn interactions(&self) -> anyhow::Result<Vec<Interaction>> {
        let mut table = Vec::new();
        for i in 0..3 {
            for j in 0..3 {
                table.push(Interaction::new(&InteractionSettings {
                    materials: [self.materials[i], self.materials[j]],
                    parameters: self.parameters[i.max(j)],
                    attraction: 0.0,
                    end: self.end,
                })?);
            }
        }
        Ok(table)
    }
}
