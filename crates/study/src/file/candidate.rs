//! The `[[candidate]]` table.

use super::parts::NUMBER;
use super::{CandidateEntry, settings};
use crate::document::Fields;
use crate::keys;
use crate::problem::Problems;
use std::collections::BTreeMap;

/// A `[[candidate]]`; whether its observables are those of the scene is asked later.
pub(super) fn candidate(fields: &Fields<'_>, problems: &mut Problems) -> Option<CandidateEntry> {
    fields.check_keys(&keys::CANDIDATE, problems);
    let scene = fields.required("scene", "the name of a [[scene]]", problems);
    let condition = fields.table("condition", problems);
    let condition = condition.map(|c| settings(&c, problems));
    let observables = fields.optional("observables", "a list of names", problems);
    let mut sd = BTreeMap::new();
    if let Some(table) = fields.table("sd", problems) {
        for name in table.table.keys() {
            let value: Option<f64> = table.optional(name, NUMBER, problems);
            let Some(value) = value else { continue };
            if value.is_finite() && value > 0.0 {
                sd.insert(name.clone(), value);
            } else {
                problems.add(table.wrong(name, "must be above 0, in the unit of the observable"));
            }
        }
    }
    let mut positive = |key: &str, least: f64, problem: &str| {
        let value: Option<f64> = fields.optional(key, NUMBER, problems);
        let usable = |x: &f64| x.is_finite() && *x > 0.0 && *x >= least;
        if value.is_some_and(|x| !usable(&x)) {
            problems.add(fields.wrong(key, problem));
        }
        value.filter(usable)
    };
    let n = positive(
        "n",
        1.0,
        "must be 1 or more: the number of photos or repeats",
    );
    let minutes = positive(
        "minutes",
        0.0,
        "must be above 0: the work in the laboratory",
    );
    Some(CandidateEntry {
        scene: scene?,
        condition: condition.unwrap_or_default(),
        observables,
        sd,
        n,
        minutes,
        path: fields.path.clone(),
    })
}
