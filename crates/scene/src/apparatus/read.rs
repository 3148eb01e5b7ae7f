//! Reading of an apparatus from the table of a file.

use super::{Apparatus, KINDS};
use serde::de::{DeserializeOwned, Error};
use serde::{Deserialize, Deserializer};
use toml::{Table, Value};

// A derived reader of a tagged enum names neither the kind nor the key at which it fails.
impl<'de> Deserialize<'de> for Apparatus {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut table = Table::deserialize(deserializer)?;
        let refused =
            |what: String| D::Error::custom(format!("{what}; it is one of {}", KINDS.join(", ")));
        let kind = match table.remove("kind") {
            Some(Value::String(kind)) => kind,
            Some(other) => {
                return Err(refused(format!(
                    "kind = {other} is not the name of an apparatus"
                )));
            }
            None => return Err(refused("kind is missing".to_owned())),
        };
        let Some(read) = Self::of_kind(&kind, table) else {
            return Err(D::Error::unknown_variant(&kind, KINDS));
        };
        read.map_err(|error| {
            // "WHAT\nin `KEY`\n", or "WHAT\n" where no value is to blame.
            let told = error.to_string();
            let told = told.trim_end();
            D::Error::custom(match told.rsplit_once("\nin `") {
                Some((what, key)) => {
                    let key = key.trim_end_matches('`');
                    format!("{key} of the {kind}: {what}")
                }
                None => format!("{kind}: {told}"),
            })
        })
    }
}

/// The settings of one kind.
pub(super) fn settings<T: DeserializeOwned>(table: Table) -> Result<T, toml::de::Error> {
    T::deserialize(Value::Table(table))
}
