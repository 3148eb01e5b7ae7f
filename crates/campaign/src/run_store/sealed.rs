//! A digest of the content of a file, written with it and checked before the content is used.

use serde::Serialize;
use serde_json::{Map, Value};

use crate::run_store::canonical::{digest, hexadecimal};

/// Name of the digest in a file.
const DIGEST: &str = "digest";

/// Name of the list of fields that the digest excludes.
const UNCOUNTED: &str = "not_in_digest";

/// Something with its digest.
#[derive(Serialize)]
struct Sealed<'a, T> {
    /// SHA-256 of all other fields of the file that it includes, see [`digest`].
    digest: &'a str,
    /// Places of the excluded fields.
    #[serde(rename = "not_in_digest", skip_serializing_if = "<[_]>::is_empty")]
    uncounted: &'a [&'a str],
    /// The rest of the file.
    #[serde(flatten)]
    content: &'a T,
}

/// Writes something with named fields as indented JSON, with a field `digest` before them: the SHA-256 of all others.
///
/// # Errors
///
/// A value that cannot be written as JSON, or that has no named fields.
pub fn seal(content: &impl Serialize) -> Result<Vec<u8>, serde_json::Error> {
    seal_without(content, &[])
}

/// The same with fields that the digest excludes, such as elapsed times, each by its JSON pointer (`/cost/wall_s`,
/// RFC 6901). The file lists them in `not_in_digest`, and the digest includes that list.
///
/// # Errors
///
/// As [`seal`].
pub fn seal_without(
    content: &impl Serialize,
    uncounted: &[&str],
) -> Result<Vec<u8>, serde_json::Error> {
    // As a reader will see it: a number of single precision has other digits in a value than in a text.
    let seen: Value = serde_json::from_slice(&serde_json::to_vec(content)?)?;
    let found = digest(&counted(&seen, uncounted)).map_err(serde::ser::Error::custom)?;
    let file = Sealed {
        digest: &found,
        uncounted,
        content,
    };
    let mut bytes = serde_json::to_vec_pretty(&file)?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// Reads what [`seal`] or [`seal_without`] wrote; white space and the order of the names do not count.
///
/// # Errors
///
/// The fault of the bytes, as the end of a sentence about the file: no JSON, no digest, or altered.
pub fn unseal(bytes: &[u8]) -> Result<Value, String> {
    let mut value: Value = serde_json::from_slice(bytes).map_err(|why| why.to_string())?;
    let Some(fields) = value.as_object_mut() else {
        return Err("it has no names".to_owned());
    };
    let told = take_digest(fields)?;
    let uncounted = match fields.remove(UNCOUNTED) {
        None => Vec::new(),
        Some(list) => serde_json::from_value::<Vec<String>>(list)
            .map_err(|why| format!("its {UNCOUNTED} must be a list of names: {why}"))?,
    };
    let uncounted: Vec<&str> = uncounted.iter().map(String::as_str).collect();
    check(&counted(&value, &uncounted), &told)?;
    Ok(value)
}

/// Content of a digest: the value without some fields, and with their list if there are any.
fn counted(content: &Value, uncounted: &[&str]) -> Value {
    let mut value = content.clone();
    for pointer in uncounted {
        if let Some((owner, name)) = pointer.rsplit_once('/')
            && let Some(Value::Object(fields)) = value.pointer_mut(owner)
        {
            fields.remove(name);
        }
    }
    if let Value::Object(fields) = &mut value
        && !uncounted.is_empty()
    {
        fields.insert(UNCOUNTED.to_owned(), uncounted.to_vec().into());
    }
    value
}

/// Removes the digest from the fields of a file.
pub(crate) fn take_digest(fields: &mut Map<String, Value>) -> Result<String, String> {
    match fields.remove(DIGEST) {
        Some(Value::String(told)) => Ok(told),
        _ => Err("it has no digest".to_owned()),
    }
}

/// Compares the content of a file with its digest.
pub(crate) fn check(content: &Value, told: &str) -> Result<(), String> {
    let found = digest(content).map_err(|why| why.to_string())?;
    if found == told {
        return Ok(());
    }
    Err(format!(
        "it was altered: its content has the digest {found}, it states {told}"
    ))
}

/// Puts a JSON text of `owner`, such as the key of a run, into a file with its digest: fast, for what is large and written
/// often.
pub fn seal_text(owner: &str, json: &[u8]) -> Vec<u8> {
    let mut bytes = head(&digest_of_text(owner, json)).into_bytes();
    bytes.extend_from_slice(json);
    bytes.extend_from_slice(TAIL.as_bytes());
    bytes
}

/// The JSON text of an owner in a file that [`seal_text`] wrote; every byte counts.
///
/// # Errors
///
/// The fault of the bytes, as the end of a sentence about the file: no such file, or altered, or of another owner.
pub fn unseal_text<'b>(owner: &str, bytes: &'b [u8]) -> Result<&'b [u8], String> {
    let length = head("").len() + DIGITS;
    let inner = bytes.split_at_checked(length).and_then(|(start, rest)| {
        let json = rest.strip_suffix(TAIL.as_bytes())?;
        Some((start, json))
    });
    let (start, json) = inner.ok_or_else(|| "it is not whole".to_owned())?;
    if start != head(&digest_of_text(owner, json)).as_bytes() {
        return Err("it was altered or is of another run: its digest does not fit".to_owned());
    }
    Ok(json)
}

/// Digits of a digest.
const DIGITS: usize = 64;
/// The end of a file that [`seal_text`] wrote.
const TAIL: &str = "}\n";

/// The start of such a file.
fn head(digest: &str) -> String {
    format!("{{\"{DIGEST}\":\"{digest}\",\"content\":")
}

/// Digest of a text and of its owner.
fn digest_of_text(owner: &str, json: &[u8]) -> String {
    let mut all = owner.as_bytes().to_vec();
    all.push(b'\n');
    all.extend_from_slice(json);
    hexadecimal(&all)
}
