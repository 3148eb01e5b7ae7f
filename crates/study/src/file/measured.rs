//! `[[measured]]`: any key that is not its own is the name of an observable.

use super::{MeasuredCorrelation, MeasuredValue, PhotoOptions, condition};
use inference::Role;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;

/// What was measured at one condition of a scene.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MeasuredEntry {
    pub(crate) path: String,
    /// Name of the scene.
    pub(crate) scene: String,
    /// Settings of the scene by path or short name, with the values as text.
    pub(crate) condition: BTreeMap<String, String>,
    pub(crate) role: Role,
    /// Means by observable.
    pub(crate) values: BTreeMap<String, MeasuredValue>,
    /// Which of the means are correlated, as the file states it.
    pub(crate) correlations: Vec<MeasuredCorrelation>,
    /// Photos or folders of them, relative to the study file.
    pub(crate) photos: Vec<PathBuf>,
    pub(crate) photo: PhotoOptions,
    /// A curve that was measured.
    pub(crate) curve: Option<CurveEntry>,
}

/// A measured curve, of which polynomials take a few numbers.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(
    deny_unknown_fields,
    expecting = "a curve { file = \"...\", sd = ..., correlation_length = ..., scores = ... }"
)]
pub(crate) struct CurveEntry {
    /// Its table, relative to the study file.
    pub(crate) file: PathBuf,
    /// Standard deviation of one value, in the unit of its column.
    pub(crate) sd: Option<f64>,
    /// Length over which deviations are correlated, in the unit of the first column.
    pub(crate) correlation_length: Option<f64>,
    /// Number of scores.
    #[serde(default = "usual_scores")]
    pub(crate) scores: usize,
}

/// Level, slope and bend.
fn usual_scores() -> usize {
    3
}

/// A folder, or a list of files.
#[derive(Deserialize)]
#[serde(untagged, expecting = "must be a folder, or a list of files")]
enum Photos {
    One(PathBuf),
    Many(Vec<PathBuf>),
}

/// The correlation of two observables.
#[derive(Deserialize)]
#[serde(expecting = "a list of [\"OBSERVABLE\", \"OBSERVABLE\", correlation]")]
struct Stated(String, String, f64);

/// A condition, of a number or a text for each setting.
#[derive(Deserialize)]
struct Condition(#[serde(deserialize_with = "condition")] BTreeMap<String, String>);

// By hand, since serde loses the place of a mistake behind `flatten`.
impl<'de> Deserialize<'de> for MeasuredEntry {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_map(Entries)
    }
}

struct Entries;

impl<'de> Visitor<'de> for Entries {
    type Value = MeasuredEntry;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table of keys")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<MeasuredEntry, A::Error> {
        let (mut path, mut scene, mut role) = (None, None, None);
        let (mut condition, mut values) = (BTreeMap::new(), BTreeMap::new());
        let (mut correlations, mut photos) = (Vec::new(), Vec::new());
        let mut photo = PhotoOptions::default();
        let mut curve = None;
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                crate::document::PATH => path = Some(map.next_value()?),
                "scene" => scene = Some(map.next_value()?),
                "condition" => condition = map.next_value::<Condition>()?.0,
                "role" => role = Some(map.next_value()?),
                "photos" => {
                    photos = match map.next_value()? {
                        Photos::One(one) => vec![one],
                        Photos::Many(many) => many,
                    }
                }
                "photo" => photo = map.next_value()?,
                "curve" => curve = Some(map.next_value()?),
                "correlation" => {
                    let stated: Vec<Stated> = map.next_value()?;
                    let each = stated.into_iter();
                    let each = each.map(|Stated(a, b, value)| MeasuredCorrelation { a, b, value });
                    correlations = each.collect();
                }
                _ => drop(values.insert(key, map.next_value()?)),
            }
        }
        Ok(MeasuredEntry {
            path: path.unwrap_or_default(),
            scene: scene.ok_or_else(|| A::Error::missing_field("scene"))?,
            condition,
            role: role.ok_or_else(|| A::Error::missing_field("role"))?,
            values,
            correlations,
            photos,
            photo,
            curve,
        })
    }
}
