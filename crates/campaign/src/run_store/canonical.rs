//! One text for one content, and the key made of it.

use serde_json::{Number, Value};
use sha2::{Digest, Sha256};
use std::fmt::Write as _;

use crate::run_store::Error;

/// Version of the form of a record file and of its key; raised when either changes.
pub const SCHEMA: u32 = 3;

/// Largest whole number up to which every float is exact, 2^53.
const EXACT_WHOLE: f64 = 9_007_199_254_740_992.0;

/// Writes a JSON value in the one form that equal contents share.
///
/// Map keys are sorted by their bytes, there is no white space, floats have the fewest digits
/// that read back to the same number, whole floats below 2^53 are written as integers, and minus
/// zero as zero.
///
/// # Errors
///
/// [`Error::NullInput`] when a null occurs anywhere: JSON has no NaN and no infinity, and what
/// makes JSON of a float writes null for them.
pub fn canonical_json(value: &Value) -> Result<String, Error> {
    let mut text = String::new();
    write_value(value, Form::Key, &|| "inputs".to_owned(), &mut text)?;
    Ok(text)
}

/// Gives the SHA-256, in lower-case hexadecimal, of a JSON value: of its text with sorted map keys and without white
/// space.
///
/// Unlike in a key, null is a value like others, and numbers differ if their text in a file differs: 1 is not 1.0
/// and minus zero is not zero.
///
/// # Errors
///
/// None at present: nulls, the one thing that a canonical text may refuse, are accepted.
pub(crate) fn digest(value: &Value) -> Result<String, Error> {
    let mut text = String::new();
    write_value(value, Form::Digest, &|| "record".to_owned(), &mut text)?;
    Ok(hexadecimal(text.as_bytes()))
}

/// Gives the key of a run: SHA-256, in lower-case hexadecimal, of the canonical JSON of
/// [`SCHEMA`], the version of the code, the inputs and the seed.
///
/// # Errors
///
/// [`Error::NullInput`] when the inputs hold a null.
pub fn run_key(version: &str, inputs: &Value, seed: u64) -> Result<String, Error> {
    let text = format!(
        "{{\"inputs\":{},\"schema\":{SCHEMA},\"seed\":{seed},\"version\":{}}}",
        canonical_json(inputs)?,
        Value::from(version)
    );
    Ok(hexadecimal(text.as_bytes()))
}

/// Use of a canonical text.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Form {
    /// A key: equal numbers are equal texts, and null is refused.
    Key,
    /// A digest of what a file holds, null included.
    Digest,
}

/// SHA-256 of bytes, in lower-case hexadecimal.
pub(crate) fn hexadecimal(bytes: &[u8]) -> String {
    let mut digits = String::with_capacity(64);
    for byte in Sha256::digest(bytes) {
        // Writing to a string cannot fail.
        let _ = write!(digits, "{byte:02x}");
    }
    digits
}

/// Appends the canonical form of a value; `place` names it in an error.
fn write_value(
    value: &Value,
    form: Form,
    place: &dyn Fn() -> String,
    text: &mut String,
) -> Result<(), Error> {
    match value {
        Value::Null if form == Form::Key => {
            return Err(Error::NullInput { place: place() });
        }
        Value::Number(number) if form == Form::Key => text.push_str(&canonical_number(number)),
        Value::Null | Value::Bool(_) | Value::String(_) | Value::Number(_) => {
            text.push_str(&value.to_string());
        }
        Value::Array(items) => {
            text.push('[');
            for (i, item) in items.iter().enumerate() {
                if i > 0 {
                    text.push(',');
                }
                write_value(item, form, &|| format!("{}[{i}]", place()), text)?;
            }
            text.push(']');
        }
        Value::Object(map) => {
            let mut entries: Vec<_> = map.iter().collect();
            entries.sort_by(|a, b| a.0.cmp(b.0));
            text.push('{');
            for (i, (name, item)) in entries.into_iter().enumerate() {
                if i > 0 {
                    text.push(',');
                }
                text.push_str(&Value::from(name.as_str()).to_string());
                text.push(':');
                write_value(item, form, &|| format!("{}.{name}", place()), text)?;
            }
            text.push('}');
        }
    }
    Ok(())
}

/// Writes a number so that equal numbers have equal texts.
fn canonical_number(number: &Number) -> String {
    match number.as_f64() {
        Some(x) if number.is_f64() && x == 0.0 => "0".to_owned(),
        Some(x) if number.is_f64() && x.fract() == 0.0 && x.abs() < EXACT_WHOLE => {
            format!("{x:.0}")
        }
        Some(x) if number.is_f64() => format!("{x:?}"),
        _ => number.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::{canonical_json, digest, run_key};
    use crate::run_store::Error;
    use serde_json::{Value, json};

    #[test]
    fn canonical_form_sorts_keys_and_drops_white_space() {
        let value: Value =
            serde_json::from_str(r#"{ "b" : [1, 2.5e-7, true], "a": {"z": "q\"", "y": 0.1} }"#)
                .unwrap();
        assert_eq!(
            canonical_json(&value).unwrap(),
            r#"{"a":{"y":0.1,"z":"q\""},"b":[1,2.5e-7,true]}"#
        );
    }

    #[test]
    fn key_does_not_depend_on_the_order_of_map_keys() {
        let one: Value = serde_json::from_str(r#"{"rpm": 10, "fill": 0.2}"#).unwrap();
        let other: Value = serde_json::from_str(r#"{"fill": 0.2, "rpm": 10}"#).unwrap();
        assert_eq!(
            run_key("1", &one, 3).unwrap(),
            run_key("1", &other, 3).unwrap()
        );
    }

    #[test]
    fn equal_numbers_share_a_key_and_the_next_float_does_not() {
        let key = |x: f64| run_key("1", &json!({ "x": x }), 3).unwrap();
        assert_eq!(key(0.0), key(-0.0));
        assert_eq!(key(10.0), run_key("1", &json!({"x": 10}), 3).unwrap());
        assert_ne!(key(0.1), key(0.1_f64.next_up()));
        assert_ne!(key(1e300), key(1e300_f64.next_up()));
    }

    #[test]
    fn key_differs_when_version_seed_or_an_input_differs() {
        let base = run_key("1", &json!({"x": 1.5}), 3).unwrap();
        assert_ne!(base, run_key("2", &json!({"x": 1.5}), 3).unwrap());
        assert_ne!(base, run_key("1", &json!({"x": 1.5}), 4).unwrap());
        assert_ne!(base, run_key("1", &json!({"y": 1.5}), 3).unwrap());
    }

    /// The digest was computed independently with the `sha256sum` command.
    #[test]
    fn key_is_the_sha_256_of_the_canonical_text() {
        assert_eq!(
            run_key("0.1.0", &json!({"b": 0.5, "a": 1.0}), 7).unwrap(),
            "13cecc5dddeb447355f1a792cfd29bd2a70a4460194d44c9d1b639e4feb48f6e"
        );
    }

    /// Null is a value like others, and numbers that differ in a file have different digests. The digest was
    /// computed independently, of `{"a":[null,1,1.0,-0.0],"b":"x"}` with the `sha256sum` command.
    #[test]
    fn digest_is_the_sha_256_of_exactly_what_a_file_holds() {
        let value = json!({"b": "x", "a": [null, 1, 1.0, -0.0]});
        assert_eq!(
            digest(&value).unwrap(),
            "cdbb699f104b5d4c928c1458252a909f288d59cce54bdf63185e252eefa650d8"
        );
        let of_one = |x: Value| digest(&x).unwrap();
        assert_ne!(of_one(json!(1)), of_one(json!(1.0)));
        assert_ne!(of_one(json!(0.0)), of_one(json!(-0.0)));
        assert_ne!(of_one(json!({"x": null})), of_one(json!({})));
    }

    #[test]
    fn not_a_number_is_refused_with_its_place() {
        let refused = canonical_json(&json!({"condition": {"rpm": [1.0, f64::NAN]}}));
        assert!(
            matches!(&refused, Err(Error::NullInput { place }) if place == "inputs.condition.rpm[1]"),
            "{refused:?}"
        );
    }
}
