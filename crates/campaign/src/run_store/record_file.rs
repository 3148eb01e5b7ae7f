//! The file of a record: its text with a digest, and a reader that checks everything.

use serde_json::Value;

use crate::run_store::sealed::{check, seal, take_digest};
use crate::run_store::{Error, Record, SCHEMA, run_key};

/// Writes a record as the bytes of its file.
///
/// # Errors
///
/// [`Error::Unwritable`] if the record cannot be written as JSON.
pub(crate) fn to_bytes(record: &Record) -> Result<Vec<u8>, Error> {
    seal(record).map_err(|source| Error::Unwritable {
        key: record.key.clone(),
        source,
    })
}

/// Reads the record of a key from the bytes of a file.
///
/// # Errors
///
/// The fault of the bytes: no record at all, of another schema, altered, or of another key.
pub(crate) fn from_bytes(bytes: &[u8], key: &str) -> Result<Record, String> {
    let mut value: Value = serde_json::from_slice(bytes).map_err(|why| why.to_string())?;
    let fields = value
        .as_object_mut()
        .ok_or_else(|| "it is not a record".to_owned())?;
    match fields.get("schema").and_then(Value::as_u64) {
        Some(schema) if schema == u64::from(SCHEMA) => {}
        Some(schema) => {
            return Err(format!(
                "it has schema {schema}, this program reads {SCHEMA}"
            ));
        }
        None => return Err("it has no schema".to_owned()),
    }
    let told = take_digest(fields)?;
    check(&value, &told)?;
    let record: Record = serde_json::from_value(value).map_err(|why| why.to_string())?;
    let content_key =
        run_key(&record.version, &record.inputs, record.seed).map_err(|why| why.to_string())?;
    if content_key != key || record.key != key {
        return Err(format!(
            "it was renamed: its content has the key {content_key}"
        ));
    }
    Ok(record)
}
