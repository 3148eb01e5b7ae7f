//! Settings of a scene as numbers, in the unit that a parameter states.

use input::quantity::{
    Angle, AngularSpeed, Density, Frequency, Length, Mass, Pressure, Speed, Time,
};
use scene::{Scene, setting_at};
use toml::{Table, Value};

/// Why a setting is not a number in a unit, with the remedy.
pub(crate) type NoNumber = String;

/// Every setting of a scene that has a value, as a table.
pub(crate) fn table_of(scene: &Scene) -> Table {
    // A scene that was read can be written; an empty table has no setting.
    Table::try_from(scene).unwrap_or_default()
}

/// The setting at a dotted path; none for a whole table or list.
pub(crate) fn leaf<'a>(table: &'a Table, path: &str) -> Option<&'a Value> {
    let value = setting_at(table, path)?;
    (!matches!(value, Value::Table(_) | Value::Array(_))).then_some(value)
}

/// Paths of all settings that hold a number or a quantity, for messages.
pub(crate) fn paths(table: &Table) -> Vec<String> {
    fn walk(value: &Value, path: &str, out: &mut Vec<String>) {
        let below = |key: &str| match path {
            "" => key.to_owned(),
            _ => format!("{path}.{key}"),
        };
        match value {
            Value::Table(table) => {
                table.iter().for_each(|(key, v)| walk(v, &below(key), out));
            }
            Value::Array(list) => {
                let items = list.iter().enumerate();
                items.for_each(|(k, v)| walk(v, &below(&k.to_string()), out));
            }
            Value::Integer(_) | Value::Float(_) => out.push(path.to_owned()),
            Value::String(text) if text.starts_with(|c: char| c.is_ascii_digit()) => {
                out.push(path.to_owned());
            }
            _ => {}
        }
    }
    let mut out = Vec::new();
    walk(&Value::Table(table.clone()), "", &mut out);
    out
}

/// A setting as a number in a unit.
pub(crate) fn number(value: &Value, unit: Option<&str>) -> Result<f64, NoNumber> {
    let plain = |x: f64| match unit {
        None | Some("" | "1") => Ok(x),
        Some(unit) => Err(format!(
            "is a plain number: leave out the unit '{unit}' of the parameter"
        )),
    };
    match value {
        #[expect(clippy::cast_precision_loss, reason = "counts of a scene are small")]
        Value::Integer(whole) => plain(*whole as f64),
        Value::Float(x) => plain(*x),
        Value::String(text) => match unit {
            None | Some("" | "1") => Err(format!(
                "is a quantity ({text}): state the unit of low and high, such as unit = \"{}\"",
                text.split_whitespace().nth(1).unwrap_or("mm")
            )),
            Some(unit) => in_unit(text, unit)
                .ok_or_else(|| format!("is {text}, which has no value in '{unit}'")),
        },
        other => Err(format!("is {other}, not a number")),
    }
}

/// A quantity in another unit of the same kind; `None` if the kinds differ.
fn in_unit(text: &str, unit: &str) -> Option<f64> {
    let one = format!("1 {unit}");
    macro_rules! of_kind {
        ($($kind:ty),*) => {
            $(if let (Ok(value), Ok(one)) = (<$kind>::parse(text), <$kind>::parse(&one)) {
                return Some(value.si() / one.si());
            })*
        };
    }
    of_kind!(
        Length,
        Angle,
        AngularSpeed,
        Time,
        Mass,
        Density,
        Pressure,
        Speed,
        Frequency
    );
    None
}

#[cfg(test)]
mod tests {
    use super::number;
    use toml::Value;

    /// 0.00045 m are 0.45 mm up to rounding; 2 kHz and 10 rpm are not lengths.
    #[test]
    fn a_quantity_is_read_in_the_unit_of_the_parameter() {
        let text = |t: &str| Value::String(t.into());
        let mm = number(&text("0.00045 m"), Some("mm")).unwrap();
        assert!((mm - 0.45).abs() < 1e-15, "{mm}");
        let rpm = number(&text("1 rad/s"), Some("rpm")).unwrap();
        assert!((rpm - 30.0 / std::f64::consts::PI).abs() < 1e-14, "{rpm}");
        assert_eq!(number(&Value::Float(0.3), None), Ok(0.3));
        let error = number(&text("0.00045 m"), None).unwrap_err();
        assert!(error.contains("unit = \"m\""), "{error}");
        number(&text("10 rpm"), Some("mm")).unwrap_err();
        number(&Value::Float(0.3), Some("mm")).unwrap_err();
    }
}
