//! The file of a record: its text with a digest, and reading it without believing anything.

use serde::Serialize;
use serde_json::Value;

use crate::canonical::digest;
use crate::{Error, Record, SCHEMA, run_key};

/// Name of the digest in a file.
const DIGEST: &str = "digest";

/// What a record file holds.
#[derive(Serialize)]
struct RecordFile<'a> {
    /// SHA-256 of everything else in the file, see [`digest`].
    digest: &'a str,
    /// The record.
    #[serde(flatten)]
    record: &'a Record,
}

/// Writes a record as the bytes of its file.
///
/// # Errors
///
/// [`Error::Unwritable`] when the record cannot be put into words.
pub(crate) fn to_bytes(record: &Record) -> Result<Vec<u8>, Error> {
    let unwritable = |source| Error::Unwritable {
        key: record.key.clone(),
        source,
    };
    let value = serde_json::to_value(record).map_err(unwritable)?;
    let file = RecordFile {
        digest: &digest(&value)?,
        record,
    };
    let mut bytes = serde_json::to_vec_pretty(&file).map_err(unwritable)?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// Reads the record of a key from the bytes of a file.
///
/// # Errors
///
/// Why the bytes are not this record: no record at all, of another schema, altered, or of another key.
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
    let Some(Value::String(told)) = fields.remove(DIGEST) else {
        return Err("it has no digest".to_owned());
    };
    let found = digest(&value).map_err(|why| why.to_string())?;
    if found != told {
        return Err(format!(
            "it was altered: its content has the digest {found}, it states {told}"
        ));
    }
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
