//! The list of checks.

use crate::{
    CheckError, Error, Row, agglomerate, bond_beam, chung_ooi, cohesion, determinism,
    energy_ledger, free_rotation, laws, liquid, maw, restitution, rolling, size_ratio,
    spinning_wall, walls, whole_seed,
};

/// A check: some rows that one computation gives.
#[derive(Debug, Clone, Copy)]
pub struct Check {
    /// Name, as `--only` takes it.
    pub name: &'static str,
    compute: fn() -> Result<Vec<Row>, CheckError>,
}

/// All checks.
pub fn suite() -> Vec<Check> {
    let check = |name, compute| Check { name, compute };
    vec![
        check("chung-ooi-1-2", chung_ooi::elastic_impacts),
        check("chung-ooi-3", chung_ooi::restitutions),
        check("chung-ooi-4-5", chung_ooi::oblique_impacts),
        check("chung-ooi-6-8", chung_ooi::spinning_impacts),
        check("maw", maw::curve),
        check("restitution-speed", restitution::against_speed),
        check("restitution-trap", restitution::trap),
        check("slip-to-roll", rolling::slip_to_roll),
        check("incline", rolling::inclines),
        check("rolling-lever", rolling::dumb_bell),
        check("free-rotation", free_rotation::free_rotation),
        check("gravity-overlap", agglomerate::gravity),
        check("rebound-sphere-count", agglomerate::rebound),
        check("whole-seed-damping", whole_seed::falls),
        check("energy-ledger", energy_ledger::running_drum),
        check("mesh-wall", walls::mesh_and_analytic),
        check("moving-wall", walls::moving),
        check("spinning-wall", spinning_wall::spinning),
        check("bond-beam", bond_beam::beam),
        check("size-ratio", size_ratio::three_spheres),
        check("laws", laws::laws),
        check("cohesion-by-area", cohesion::cohesion),
        check("liquid-bridge", liquid::bridges),
        check("determinism", determinism::same_bits),
    ]
}

/// Does the checks whose names are given, or all if none is; `progress` hears each name.
///
/// # Errors
///
/// A name that no check has, a check that could not be done at all.
pub fn run(only: &[String], mut progress: impl FnMut(&str)) -> Result<Vec<Row>, Error> {
    let all = suite();
    if let Some(name) = only.iter().find(|n| !all.iter().any(|c| c.name == **n)) {
        let known: Vec<_> = all.iter().map(|c| c.name).collect();
        return Err(Error::NoSuchCheck {
            name: name.clone(),
            known: known.join(", "),
        });
    }
    let mut rows = Vec::new();
    for check in all {
        if !only.is_empty() && !only.iter().any(|n| n == check.name) {
            continue;
        }
        progress(check.name);
        rows.extend((check.compute)().map_err(|source| Error::Solver {
            check: check.name,
            source,
        })?);
    }
    Ok(rows)
}
