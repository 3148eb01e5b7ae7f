//! Materials and contact laws in the words of LIGGGHTS.

use super::{TOOL, list};
use crate::exchange::Error;
use crate::exchange::drum_deck::{Shares, coheres, restitution_of_body};
use crate::exchange::vtk::add;
use contact_law::NormalForceEnd;
use scene::{ContactSettings, Drum, RollingLaw, Scene, SeedBody};
use std::sync::Arc;

/// Restitutions that it takes lie above this.
const LEAST_RESTITUTION: f64 = 0.05;
/// Young's modulus below which LIGGGHTS wants `soft_particles`, Pa.
const SOFT: f64 = 5e6;

/// The contact laws in the words of LIGGGHTS.
pub(super) struct Law {
    /// Commands that state the properties of the materials and their pairs.
    pub(super) properties: String,
    /// The model, before the shape of a wall.
    pub(super) model: String,
    /// Its settings, behind the shape.
    pub(super) settings: String,
    /// The command that allows materials as soft as these; empty if LIGGGHTS takes them without.
    pub(super) soft: &'static str,
}

/// The materials of seeds, shell and cover of a drum, one type of atoms each.
pub(super) fn surfaces<'a>(scene: &'a Scene, drum: &'a Drum) -> [&'a str; 3] {
    [&scene.seed[0].material, &drum.shell, &drum.cover]
}

/// The contacts of the first material with each.
fn contacts<'a>(scene: &'a Scene, names: &[&str]) -> Result<Vec<&'a ContactSettings>, Error> {
    let contact = |name: &&str| -> Result<&ContactSettings, Error> {
        let missing = || scene::Error::MissingContact {
            file: scene.file.clone(),
            pair: format!("{}-{name}", names[0]),
        };
        Ok(scene.contact_of(names[0], name).ok_or_else(missing)?)
    };
    names.iter().map(contact).collect()
}

/// Refuses values of the materials of a deck, the seeds' first, at which it stops when it reads the deck; `mass_share` is that of a sphere that touches, over its body.
pub(super) fn refuse_values(scene: &Scene, names: &[&str], mass_share: f64) -> Result<(), Error> {
    let refused = |what: String, way_out| {
        Err(Error::NotThere {
            what,
            tool: TOOL,
            way_out,
        })
    };
    for (contact, name) in contacts(scene, names)?.iter().zip(names) {
        let restitution = restitution_of_body(contact.restitution.get(), mass_share);
        if restitution <= LEAST_RESTITUTION {
            let shown = input::quantity::significant(restitution, 3);
            let what = format!("restitution {shown} between {} and {name}", names[0]);
            return refused(what, "it takes values above 0.05 alone");
        }
    }
    for name in names {
        let ratio = scene.material[*name].poisson_ratio.get();
        if ratio < 0.0 {
            let what = format!("Poisson's ratio {ratio} of {name}");
            return refused(what, "it takes values from 0 to 0.5 alone");
        }
    }
    Ok(())
}

/// The laws of the contacts of a scene between its seeds, whose material is the first, and materials of walls.
pub(super) fn law(scene: &Scene, names: &[&str], bodies: &[Arc<SeedBody>]) -> Result<Law, Error> {
    let n = names.len();
    let materials = || names.iter().map(|name| &scene.material[*name]);
    let young: Vec<f64> = materials()
        .map(scene::MaterialSettings::youngs_modulus_pa)
        .collect();
    let poisson = materials().map(|m| m.poisson_ratio.get());
    let contacts = contacts(scene, names)?;
    // Row by row; walls never meet.
    let pairs = |of: &dyn Fn(&ContactSettings) -> f64| {
        let table = (0..n).flat_map(|i| (0..n).map(move |j| usize::max(i, j)));
        list(table.map(|k| of(contacts[k])))
    };
    let shares = Shares::of(scene, bodies);
    refuse_values(scene, names, shares.mass)?;
    let mut properties = format!(
        "fix young all property/global youngsModulus peratomtype {}\n\
         fix poisson all property/global poissonsRatio peratomtype {}\n\
         fix restitution all property/global coefficientRestitution peratomtypepair {n} {}\n\
         fix friction all property/global coefficientFriction peratomtypepair {n} {}\n\
         fix rolling all property/global coefficientRollingFriction peratomtypepair {n} {}\n",
        list(young.iter().copied()),
        list(poisson),
        pairs(&|c| restitution_of_body(c.restitution.get(), shares.mass)),
        pairs(&|c| c.static_friction.get()),
        pairs(&|c| c.rolling_friction.get() * shares.lever),
    );
    let rolls = contacts.iter().any(|c| c.rolling_friction.get() > 0.0);
    let mut model = "model hertz tangential history".to_owned();
    let mut settings = String::new();
    if contacts.iter().any(|c| coheres(c)) {
        model.push_str(" cohesion sjkr");
        let densities = pairs(&|c| c.cohesion_energy_density_j_m3.unwrap_or(0.0));
        add(
            &mut properties,
            format_args!(
                "fix cohesion all property/global cohesionEnergyDensity peratomtypepair {n} {densities}\n"
            ),
        );
    }
    match scene.model.rolling_law {
        RollingLaw::ConstantTorque if rolls => {
            model.push_str(" rolling_friction cdt");
            settings.push_str(" torsionTorque on");
        }
        RollingLaw::SpringDashpot if rolls => model.push_str(" rolling_friction epsd2"),
        _ => (),
    }
    if scene.model.normal_force_end == NormalForceEnd::Clipped {
        settings.push_str(" limitForce on");
    }
    Ok(Law {
        soft: if young.iter().any(|modulus| *modulus < SOFT) {
            "soft_particles yes\n"
        } else {
            ""
        },
        properties,
        model,
        settings,
    })
}
