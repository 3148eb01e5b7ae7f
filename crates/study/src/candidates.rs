//! What could be measured next: the `[[candidate]]` tables, or the conditions that the measured ones suggest.

use crate::document::below;
use crate::file::{CandidateEntry, StudyFile};
use crate::measured::Resolved;
use crate::problem::Problems;
use crate::scenes::{Models, Scenes};
use inference::{Candidate, Measurement};
use std::collections::{BTreeMap, BTreeSet};

/// Most candidates if the file names none: each costs runs.
const MOST_SUGGESTED: usize = 6;
/// Work in the laboratory if the file names none, min: candidates are then compared by their information alone.
const MINUTES: f64 = 1.0;

/// A condition of a scene that could be measured.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Offer<'a> {
    /// Name of the scene.
    pub(crate) scene: &'a str,
    /// Settings of the scene.
    pub(crate) condition: BTreeMap<String, String>,
    /// Its entry in the file; `None` if the measured conditions suggest it.
    pub(crate) entry: Option<&'a CandidateEntry>,
}

/// The candidates of a study, in the order of the file; suggested ones if it has no such table, none if its list
/// is empty.
fn offers(file: &StudyFile) -> Vec<Offer<'_>> {
    let Some(entries) = &file.candidate else {
        return suggested(file);
    };
    let each = entries.iter().map(|entry| Offer {
        scene: &entry.scene,
        condition: entry.condition.clone(),
        entry: Some(entry),
    });
    each.collect()
}

/// For each setting with a number that the conditions of a scene state: the middle of the widest gap between its levels,
/// and a level as far beyond the highest as that is beyond the one below; half and one and a half times a lone level.
/// Then every scene that is not measured, as it is.
fn suggested(file: &StudyFile) -> Vec<Offer<'_>> {
    let mut found: Vec<Offer<'_>> = Vec::new();
    for scene in &file.scene {
        let entries: Vec<&BTreeMap<String, String>> = file
            .measured
            .iter()
            .filter(|m| m.scene == scene.name)
            .map(|m| &m.condition)
            .collect();
        let offer = |condition| Offer {
            scene: &scene.name,
            condition,
            entry: None,
        };
        if entries.is_empty() {
            found.push(offer(BTreeMap::new()));
            continue;
        }
        let names: BTreeSet<&String> = entries.iter().flat_map(|c| c.keys()).collect();
        for name in names {
            let mut levels: Vec<(f64, &str, &BTreeMap<String, String>)> = entries
                .iter()
                .filter_map(|c| {
                    let (value, unit) = number_and_unit(c.get(name)?)?;
                    Some((value, unit, *c))
                })
                .collect();
            levels.sort_by(|a, b| a.0.total_cmp(&b.0));
            levels.dedup_by(|a, b| a.0 == b.0);
            let same_unit = levels.windows(2).all(|w| w[0].1 == w[1].1);
            if !same_unit {
                continue;
            }
            for (value, about) in new_levels(&levels.iter().map(|l| l.0).collect::<Vec<_>>()) {
                let (_, unit, condition) = levels[about];
                let mut condition = condition.clone();
                let text = format!("{} {unit}", rounded(value));
                condition.insert(name.clone(), text.trim().to_owned());
                found.push(offer(condition));
            }
        }
    }
    found.truncate(MOST_SUGGESTED);
    found
}

/// Levels that could be measured beside these, which rise, each with the number of the one whose condition it shares.
fn new_levels(levels: &[f64]) -> Vec<(f64, usize)> {
    match levels {
        [] => Vec::new(),
        [one] if *one == 0.0 => Vec::new(),
        [one] => vec![(0.5 * one, 0), (1.5 * one, 0)],
        [.., before, last] => {
            let gap = |i: &usize| levels[i + 1] - levels[*i];
            // The lower of two gaps that are equally wide.
            let widest = (0..levels.len() - 1)
                .rev()
                .max_by(|a, b| gap(a).total_cmp(&gap(b)));
            let widest = widest.unwrap_or(0);
            let middle = 0.5 * (levels[widest] + levels[widest + 1]);
            vec![(middle, widest), (last + (last - before), levels.len() - 1)]
        }
    }
}

/// A number with its unit, such as `15 rpm`; none for another text.
fn number_and_unit(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    let (number, unit) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    let number: f64 = number.parse().ok()?;
    number.is_finite().then_some((number, unit.trim()))
}

/// A number with six digits that matter.
fn rounded(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}

impl Offer<'_> {
    /// Reports the fault of an entry of a file; an invalid suggestion is left out silently.
    fn refuse(&self, key: &str, problem: impl Into<String>, problems: &mut Problems) {
        if let Some(entry) = self.entry {
            problems.wrong(&below(&entry.path, key), problem);
        }
    }

    /// Standard error of each observable that it would give, of those that the scene has; empty if it is invalid.
    ///
    /// Without a standard deviation of its own an observable has the noise of the same one elsewhere in its scene, or, where
    /// the scene is not measured, in the others: the root mean square of the standard deviations and the harmonic mean of the
    /// numbers of values.
    fn standard_errors(
        &self,
        given: &[&str],
        known: &Resolved,
        problems: &mut Problems,
    ) -> BTreeMap<String, f64> {
        let measured_in = |own: bool| -> Vec<&Measurement> {
            let all = known.measurements.iter();
            all.filter(|m| (known.models.models[m.model].scene == self.scene) == own)
                .collect()
        };
        let (own, others) = (measured_in(true), measured_in(false));
        let reference = if own.is_empty() { &others } else { &own };
        let stated = |name: &str| Some(*self.entry?.sd.get(name)?);
        let asked = self.entry.and_then(|e| e.observables.clone());
        let names: Vec<String> = asked.unwrap_or_else(|| {
            let of_entry = self.entry.iter().flat_map(|e| e.sd.keys());
            let usual = reference.iter().map(|m| &m.observable);
            let usual = usual.filter(|name| given.contains(&name.as_str()));
            let all: BTreeSet<&String> = of_entry.chain(usual).collect();
            all.into_iter().cloned().collect()
        });
        let mut errors = BTreeMap::new();
        for name in names {
            if !given.contains(&name.as_str()) {
                let known = given.join(", ");
                let problem =
                    format!("'{name}' is not an observable of this scene, which gives {known}");
                self.refuse("observables", problem, problems);
                continue;
            }
            let same: Vec<&&Measurement> =
                reference.iter().filter(|m| m.observable == name).collect();
            let mean = |each: &dyn Fn(&Measurement) -> f64| {
                let sum: f64 = same.iter().map(|m| each(m)).sum();
                (!same.is_empty()).then(|| sum / same.len() as f64)
            };
            let sd = stated(&name).or_else(|| mean(&|m| m.sd * m.sd).map(f64::sqrt));
            let n = self.entry.and_then(|e| e.n);
            let n = n.or_else(|| mean(&|m| m.n.recip()).map(f64::recip));
            let Some(sd) = sd else {
                let problem = format!(
                    "'{name}' is measured nowhere, so that its noise is not known: add sd = {{ {name} = ... }}"
                );
                self.refuse("observables", problem, problems);
                continue;
            };
            errors.insert(name, sd / n.unwrap_or(1.0).sqrt());
        }
        if errors.is_empty() {
            let problem = "gives nothing that the study measures: name observables and their sd";
            self.refuse("scene", problem, problems);
        }
        errors
    }

    /// Work in the laboratory, min.
    fn minutes(&self) -> f64 {
        self.entry.and_then(|e| e.minutes).unwrap_or(MINUTES)
    }
}

/// The candidates of a study with the models that they are; those that cannot be run are reported if the file names them.
pub(crate) fn of_scenes(
    scenes: &Scenes<'_>,
    known: &Resolved,
    problems: &mut Problems,
) -> (Vec<Candidate>, Models) {
    let (mut candidates, mut models) = (Vec::new(), Models::default());
    for offer in offers(scenes.file) {
        let setup = match scenes.setup(offer.scene, &offer.condition) {
            Ok(setup) => setup,
            Err(reason) => {
                if let Some((key, problem)) = reason {
                    offer.refuse(key, problem, problems);
                }
                continue;
            }
        };
        let is_measured = |m: &Measurement| {
            known.models.models[m.model].scene == offer.scene
                && known.models.setups[m.model] == setup
        };
        if known.measurements.iter().any(is_measured) {
            let problem = "is measured already: raise n there to measure it more often";
            offer.refuse("condition", problem, problems);
            continue;
        }
        if let Some(reason) = scenes.refusal(&setup) {
            offer.refuse("condition", reason, problems);
            continue;
        }
        let given = scenes.observables(&setup);
        let standard_errors = offer.standard_errors(&given, known, problems);
        if standard_errors.is_empty() {
            continue;
        }
        let (k, is_new) = models.number_of(offer.scene, &offer.condition, setup);
        if is_new {
            candidates.push(Candidate {
                model: models.models[k].clone(),
                standard_errors,
                repeats: offer.entry.and_then(|e| e.n).unwrap_or(1.0),
                minutes: offer.minutes(),
                is_suggested: offer.entry.is_none(),
            });
        }
    }
    models.bind(&scenes.file.parameter);
    for candidate in &mut candidates {
        let bound = models
            .models
            .iter()
            .find(|m| m.name == candidate.model.name);
        candidate.model.parameters = bound.map_or_else(Vec::new, |m| m.parameters.clone());
    }
    (candidates, models)
}

#[cfg(test)]
mod tests {
    use super::{new_levels, number_and_unit};

    /// By hand: of 5, 10, 20, 30 rpm the lower of the two gaps of 10, and ten beyond the last.
    #[test]
    fn levels_between_and_beyond_are_suggested() {
        assert_eq!(new_levels(&[5.0, 10.0, 20.0, 30.0]), [(15.0, 1), (40.0, 3)]);
        assert_eq!(new_levels(&[15.0]), [(7.5, 0), (22.5, 0)]);
        assert!(new_levels(&[0.0]).is_empty() && new_levels(&[]).is_empty());
    }

    #[test]
    fn only_numbers_are_levels() {
        assert_eq!(number_and_unit(" 15 rpm"), Some((15.0, "rpm")));
        assert_eq!(number_and_unit("0.3"), Some((0.3, "")));
        assert_eq!(number_and_unit("steel"), None);
        assert_eq!(number_and_unit("inf"), None);
    }
}
