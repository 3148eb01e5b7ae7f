//! What the study file left out, and what is used instead.

use crate::file::StudyFile;
use inference::{Candidate, EffectProbe, LoopSettings};
use serde::Serialize;
use toml::Table;

/// A value that the file left out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct DefaultUsed {
    /// Key of the file.
    pub key: String,
    /// Value that is used instead.
    pub value: String,
    /// Why that.
    pub why: String,
}

/// All of them, in the order of the file.
#[derive(Debug, Default)]
pub(crate) struct Defaults {
    pub(crate) list: Vec<DefaultUsed>,
}

impl Defaults {
    pub(crate) fn tell(&mut self, key: &str, value: &str, why: &str) {
        self.list.push(DefaultUsed {
            key: key.to_owned(),
            value: value.to_owned(),
            why: why.to_owned(),
        });
    }

    /// Lists the settings of the loop that the file does not state.
    pub(crate) fn tell_design(&mut self, stated: &Table, settings: &LoopSettings) {
        let all = Table::try_from(settings).unwrap_or_default();
        for (key, value) in &all {
            // The command line gives the seed.
            if !stated.contains_key(key) && key != "seed" {
                let key = format!("design.{key}");
                self.tell(&key, &value.to_string(), "the usual setting of the loop");
            }
        }
    }

    /// Lists what is searched if the file does not say it: candidates for the next measurement, and effects.
    pub(crate) fn tell_searched(
        &mut self,
        file: &StudyFile,
        candidates: &[Candidate],
        probes: &[EffectProbe],
    ) {
        if file.candidate.is_none() && !candidates.is_empty() {
            let names: Vec<&str> = candidates.iter().map(|c| c.model.name.as_str()).collect();
            let why = "what could be measured next: levels between and beyond the measured ones, scenes not measured";
            self.tell("candidate", &names.join("; "), why);
        }
        if file.effects.search.is_none() && !file.is_of_command() {
            let why = "all effects of the library that a measured scene can carry";
            self.tell("effects.search", &probes.len().to_string(), why);
        }
    }
}
