//! The results that a command leaves: observables as JSON.

use campaign::run_store::Observation;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Largest size of an angle, deg: a turn. A larger one marks a missing result, as -999 does.
const MOST_DEGREES: f64 = 360.0;

/// What a file of results says.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Results {
    /// Observables by name.
    pub(crate) observables: BTreeMap<String, Observation>,
    /// How the run ended up.
    pub(crate) regime: Option<String>,
}

/// Reads `{"angle_deg": 31.2, "slip": {"mean": 0.1, "sd": 0.02, "n": 5}, "regime": "rolling"}`.
///
/// # Errors
///
/// A file that is missing or no JSON, a value that is neither a finite number nor such a table, in words.
pub(crate) fn read(path: &Path) -> Result<Results, String> {
    let name = path.display();
    let bytes = input::file::read(path).map_err(|error| match error.kind() {
        std::io::ErrorKind::NotFound => format!("the program left no {name}"),
        _ => format!("cannot read {name}: {error}"),
    })?;
    let value: Value = serde_json::from_slice(&bytes).map_err(|error| {
        let hint = if bytes.windows(3).any(|w| w == b"NaN") {
            "; it holds NaN, which is not a result"
        } else {
            ""
        };
        format!("{name} is not JSON: {error}{hint}")
    })?;
    let Value::Object(all) = value else {
        return Err(format!(
            "{name} must hold one table, such as {{\"angle_deg\": 31.2}}"
        ));
    };
    let mut results = Results::default();
    for (key, value) in all {
        if key == "regime" {
            results.regime = match value {
                Value::Null => None,
                Value::String(word) => Some(word),
                other => return Err(format!("{name}: regime = {other} must be a text")),
            };
            continue;
        }
        let observation = observation(&value).ok_or_else(|| {
            format!(
                "{name}: {key} = {value} must be a finite number, or a table with mean, sd and n"
            )
        })?;
        if key.ends_with("_deg") && observation.mean.abs() > MOST_DEGREES {
            return Err(format!(
                "{name}: {key} = {} must lie within {MOST_DEGREES} deg: a run without a result ends with another exit \
                 code than 0, and no number represents it",
                observation.mean
            ));
        }
        results.observables.insert(key, observation);
    }
    Ok(results)
}

/// A number, or a mean with the standard deviation of its values and their count.
fn observation(value: &Value) -> Option<Observation> {
    let with = |mean: f64, sd: Option<f64>, n: usize| Observation {
        mean,
        sd,
        n,
        unit: "as the program states".into(),
    };
    if let Some(mean) = value.as_f64() {
        return Some(with(mean, None, 1));
    }
    let table = value.as_object()?;
    if table
        .keys()
        .any(|key| !["mean", "sd", "n"].contains(&key.as_str()))
    {
        return None;
    }
    let mean = table.get("mean")?.as_f64()?;
    let n = match table.get("n") {
        None => 1,
        Some(n) => usize::try_from(n.as_u64().filter(|n| *n > 0)?).ok()?,
    };
    let sd = match table.get("sd") {
        None | Some(Value::Null) => None,
        Some(sd) => Some(sd.as_f64().filter(|sd| *sd >= 0.0)?),
    };
    Some(with(mean, sd, n))
}

#[cfg(test)]
mod tests {
    use super::read;

    fn told(text: &str) -> Result<super::Results, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.json");
        std::fs::write(&path, text).unwrap();
        read(&path)
    }

    /// A number that marks a missing result gives no result.
    #[test]
    fn an_angle_beyond_a_turn_is_refused() {
        let error = told(r#"{"angle_deg": -999}"#).unwrap_err();
        assert!(
            error.contains("angle_deg = -999 must lie within 360 deg"),
            "{error}"
        );
    }

    #[test]
    fn numbers_means_and_the_regime_are_read() {
        let text =
            r#"{"angle_deg": 31, "slip": {"mean": 0.1, "sd": 0.02, "n": 5}, "regime": "rolling"}"#;
        let results = told(text).unwrap();
        assert_eq!(results.observables["angle_deg"].mean, 31.0);
        let slip = &results.observables["slip"];
        assert_eq!((slip.sd, slip.n), (Some(0.02), 5));
        assert_eq!(results.regime.as_deref(), Some("rolling"));
    }

    #[test]
    fn what_is_no_result_is_told_with_its_place() {
        for (text, word) in [
            (r#"{"angle_deg": NaN}"#, "NaN"),
            (r#"{"angle_deg": null}"#, "angle_deg = null"),
            (r#"{"angle_deg": "31"}"#, "angle_deg = \"31\""),
            (r#"{"angle_deg": {"mean": 3, "sd": -1}}"#, "angle_deg"),
            (r#"{"angle_deg": {"mean": 3, "se": 1}}"#, "angle_deg"),
            (r#"{"angle_deg": 3"#, "line 1 column 15"),
            ("[3]", "one table"),
        ] {
            let error = told(text).unwrap_err();
            assert!(
                error.contains(word) && error.contains("results.json"),
                "{error}"
            );
        }
        let missing = read(std::path::Path::new("no/results.json")).unwrap_err();
        assert!(missing.contains("left no"), "{missing}");
    }
}
