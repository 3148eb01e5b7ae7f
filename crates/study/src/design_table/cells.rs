//! Reading the cells of a design table.

use super::columns::Setter;
use scene::{Override, SettingKind};

/// What a cell changes in the scene.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Change {
    /// A number, by a parameter of the request.
    Number {
        /// Name of the parameter.
        symbol: String,
        value: f64,
        /// Its unit; `None` of a plain number.
        unit: Option<String>,
    },
    /// A word or a switch, by a scene of its own.
    Word(String),
}

impl Change {
    /// Reads a cell; the error is its fault and the remedy.
    pub(super) fn read(text: &str, setter: &Setter) -> Result<Self, String> {
        if text.is_empty() {
            return Err("is empty: write a value, or leave the row out".to_owned());
        }
        match setter.kind {
            SettingKind::Text => Ok(Self::Word(text.to_owned())),
            // Spreadsheets write TRUE.
            SettingKind::Switch => Ok(Self::Word(text.to_lowercase())),
            SettingKind::Number => Ok(Self::Number {
                symbol: setter.symbol.clone(),
                value: natural(plain_number(text)?, setter)?,
                unit: None,
            }),
            SettingKind::Quantity => Self::quantity(text, setter),
        }
    }

    /// Reads a quantity: a plain number in the unit of the column, or a number with its unit.
    fn quantity(text: &str, setter: &Setter) -> Result<Self, String> {
        let own = number_and_unit(text);
        let Some((value, unit)) = own.filter(|_| setter.coded.is_none()) else {
            let value = plain_number(text)?;
            let Some(unit) = setter.unit.clone() else {
                return Err(format!(
                    "has no unit: write one behind the number, or in the name of the column, '{} [UNIT]'",
                    setter.paths.join(", ")
                ));
            };
            return Ok(Self::Number {
                symbol: setter.symbol.clone(),
                value: natural(value, setter)?,
                unit: Some(unit),
            });
        };
        // Each unit is a parameter of its own, so that the number stays as it was written.
        let is_usual = setter.unit.as_deref() == Some(unit);
        Ok(Self::Number {
            symbol: if is_usual {
                setter.symbol.clone()
            } else {
                format!("{} [{unit}]", setter.symbol)
            },
            value,
            unit: Some(unit.to_owned()),
        })
    }

    /// The changes of numbers at the settings of a column.
    pub(super) fn numbers(&self, setter: &Setter) -> Vec<Override> {
        let Self::Number { value, unit, .. } = self else {
            return Vec::new();
        };
        let change = |path: &String| Override::number(path, *value, unit.as_deref());
        setter.paths.iter().map(change).collect()
    }

    /// The changes of words at the settings of a column.
    pub(super) fn words(&self, setter: &Setter) -> Vec<Override> {
        let Self::Word(word) = self else {
            return Vec::new();
        };
        setter
            .paths
            .iter()
            .map(|path| Override::new(path, word))
            .collect()
    }
}

/// The natural value of a cell.
fn natural(value: f64, setter: &Setter) -> Result<f64, String> {
    let natural = setter.coded.as_ref().map_or(value, |f| f.natural(value));
    if natural.is_finite() {
        Ok(natural)
    } else {
        Err("has no finite natural value: correct it".to_owned())
    }
}

/// A finite number without unit.
fn plain_number(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x: &f64| x.is_finite());
    number.ok_or_else(|| "is not a finite number: correct it, or leave the row out".to_owned())
}

/// A number and the unit behind it; `None` of any other text.
fn number_and_unit(text: &str) -> Option<(f64, &str)> {
    // The longest beginning that is a number: `1e3 Pa` is 1e3, `5 e` is 5.
    let ends = text.char_indices().map(|(i, c)| i + c.len_utf8());
    let read = |end: usize| Some((text.get(..end)?.trim().parse::<f64>().ok()?, end));
    let (value, end) = ends.rev().find_map(read)?;
    let unit = text.get(end..)?.trim();
    (value.is_finite() && !unit.is_empty()).then_some((value, unit))
}

/// Whether a cell is a number with its unit.
pub(super) fn carries_unit(text: &str) -> bool {
    number_and_unit(text).is_some()
}

/// A message as one line.
pub(super) fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::number_and_unit;

    #[test]
    fn a_number_is_parted_from_its_unit() {
        for (text, expected) in [
            ("15 rpm", Some((15.0, "rpm"))),
            ("-2.5mm", Some((-2.5, "mm"))),
            ("1e3 Pa", Some((1000.0, "Pa"))),
            ("4.01 MPa", Some((4.01, "MPa"))),
            ("20", None),
            ("rpm", None),
            ("inf rpm", None),
            ("", None),
        ] {
            assert_eq!(number_and_unit(text), expected, "{text}");
        }
    }
}
