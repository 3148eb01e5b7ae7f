//! An apparatus as it stands in a file.

use super::Apparatus;
use serde::de::{DeserializeOwned, Error};
use serde::{Deserialize, Deserializer};
use toml::{Table, Value};

/// Kinds by their names in a file.
const KINDS: [&str; 7] = [
    "drum",
    "metering",
    "heap",
    "box-collapse",
    "slider",
    "drop",
    "tilt",
];

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
                    "kind = {other} is no name of an apparatus"
                )));
            }
            None => return Err(refused("kind is missing".to_owned())),
        };
        let read = match kind.as_str() {
            "drum" => settings(table).map(Self::Drum),
            "metering" => settings(table).map(Self::Metering),
            "heap" => settings(table).map(Self::Heap),
            "box-collapse" => settings(table).map(Self::BoxCollapse),
            "slider" => settings(table).map(Self::Slider),
            "drop" => settings(table).map(Self::Drop),
            "tilt" => settings(table).map(Self::Tilt),
            _ => return Err(D::Error::unknown_variant(&kind, &KINDS)),
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
fn settings<T: DeserializeOwned>(table: Table) -> Result<T, toml::de::Error> {
    T::deserialize(Value::Table(table))
}
