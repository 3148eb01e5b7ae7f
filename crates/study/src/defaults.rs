//! What the study file left out, and what stands in its place.

use inference::LoopSettings;
use serde::Serialize;
use toml::Table;

/// A value that the file left out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct DefaultUsed {
    /// Key of the file.
    pub key: String,
    /// What stands in its place.
    pub value: String,
    /// Why that.
    pub why: String,
}

/// All of them, in the order of the file.
#[derive(Debug, Default)]
pub(crate) struct Defaults {
    /// The list.
    pub(crate) list: Vec<DefaultUsed>,
}

impl Defaults {
    /// Tells one.
    pub(crate) fn tell(&mut self, key: &str, value: &str, why: &str) {
        self.list.push(DefaultUsed {
            key: key.to_owned(),
            value: value.to_owned(),
            why: why.to_owned(),
        });
    }

    /// Tells the settings of the loop that the file does not state.
    pub(crate) fn tell_design(&mut self, stated: &Table, settings: &LoopSettings) {
        let all = Table::try_from(settings).unwrap_or_default();
        for key in crate::keys::DESIGN {
            if let (false, Some(value)) = (stated.contains_key(key), all.get(key)) {
                let key = format!("design.{key}");
                self.tell(&key, &value.to_string(), "the usual setting of the loop");
            }
        }
    }
}
