//! Codes whose conventions are known beforehand from their source, and that no value of a parameter file converts.

use crate::Error;
use std::fmt::Write as _;

/// A convention in which a code differs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Known {
    /// Name, as the check gives it.
    pub convention: &'static str,
    /// Where the source of the code says so.
    pub source: &'static str,
}

/// A code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Code {
    /// Name for `--code`.
    pub name: &'static str,
    /// Program, version and law.
    pub law: &'static str,
    /// Conventions in which it differs, whatever is put in.
    pub known: &'static [Known],
}

const fn known(convention: &'static str, source: &'static str) -> Known {
    Known { convention, source }
}

/// The codes.
pub const CODES: [Code; 4] = [
    Code {
        name: "lammps",
        law: "LAMMPS of 22 July 2025, `pair_style granular` with `hertz/material`, `mindlin` and `coeff_restitution`",
        known: &[
            known(
                "limit-moves-spring",
                "`gran_sub_mod_tangential.cpp`, `GranSubModTangentialMindlin::calculate_forces`: beyond the limit the history becomes the scaled force less the dashpot",
            ),
            known(
                "limit-by-size",
                "`gran_sub_mod_normal.cpp`, `GranSubModNormal::set_fncrit`: the limit takes `fabs(Fntot)`",
            ),
            known(
                "rolling-without-twist",
                "`gran_sub_mod_rolling.cpp`, `GranSubModRollingSDS::calculate_forces`: the history grows by `vrl`, which has no part along the normal; `twisting` is another model",
            ),
        ],
    },
    Code {
        name: "liggghts",
        law: "LIGGGHTS 3.8.0, `gran model hertz tangential history` with `rolling_friction cdt`",
        known: &[
            known(
                "limit-of-spring",
                "`tangential_model_history.h`, `surfacesIntersect`: the dashpot is added only while the spring is below the limit",
            ),
            known(
                "limit-by-size",
                "`tangential_model_history.h`, `surfacesIntersect`: the limit takes `fabs(Fn)`",
            ),
            known(
                "rolling-by-spring",
                "`rolling_model_cdt.h`, `surfacesIntersect`: the torque takes `kn*deltan`",
            ),
        ],
    },
    Code {
        name: "mercurydpm",
        law: "MercuryDPM, `HertzianViscoelasticMindlin`, not run",
        known: &[
            known(
                "limit-of-spring",
                "`MindlinInteraction.cc`, `computeFrictionForce`: the dashpot is added only while the spring is below the limit",
            ),
            known(
                "limit-by-size",
                "`HertzianViscoelasticInteraction.cc`, `computeNormalForce`: the limit takes `std::abs(normalForce)`",
            ),
        ],
    },
    Code {
        name: "yade",
        law: "YADE 2023.02a, `Law2_ScGeom_MindlinPhys_Mindlin`",
        known: &[
            known(
                "limit-of-spring",
                "`HertzMindlin.cpp`, `Law2_ScGeom_MindlinPhys_Mindlin::go`: the dashpot is added only while the spring is below the limit",
            ),
            known(
                "history-as-force",
                "the same function: `shearElastic` is a force that grows by `ks` times the increment",
            ),
            known(
                "rolling-without-twist",
                "the same function: `momentBend` has no part along the normal, and the spring of `momentTwist` has no limit, so that it is left out",
            ),
        ],
    },
];

/// The conventions in which a code is known to differ.
///
/// # Errors
///
/// A code that is not in [`CODES`].
pub fn known_of(name: &str) -> Result<&'static Code, Error> {
    CODES.iter().find(|code| code.name == name).ok_or_else(|| {
        let names: Vec<&str> = CODES.iter().map(|code| code.name).collect();
        Error::Code {
            name: name.to_owned(),
            known: names.join(", "),
        }
    })
}

/// The codes as a table.
pub(crate) fn table() -> String {
    let mut text =
        "| `--code` | law | differs in | where its source says so |\n|---|---|---|---|\n"
            .to_owned();
    for code in &CODES {
        for Known { convention, source } in code.known {
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "| {} | {} | `{convention}` | {source} |",
                code.name, code.law
            );
        }
    }
    text
}
