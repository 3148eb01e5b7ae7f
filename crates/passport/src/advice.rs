//! A convention that differs, in words: its factor, what the other code then takes, and the value to put in.

use crate::convention::{Change, Convention, NOTHING, Value};
use crate::known_readings::known_readings;
use crate::model::Model;
use contact_law::hertz_mindlin::{damping_ratio, restitution};
use input::quantity::significant;
use serde::Serialize;

/// Largest factor that is tried.
pub(crate) const LARGEST: f64 = 10.0;
/// Distance of a factor from a known one that always counts as the same.
const NEAR: f64 = 0.03;

/// One convention that differs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// Name of the convention.
    pub convention: String,
    /// Factor of the other code over this one; `None` for one of two ways. It is the least one if the numbers leave larger ones open.
    pub factor: Option<f64>,
    /// Its 95 % interval, within the range that is tried: 0.01 to 10.
    pub interval95: Option<[f64; 2]>,
    /// What differs, by which factor, and what to put in.
    pub advice: String,
}

/// A convention that differs, with its factor in words.
pub(crate) fn difference(
    convention: &Convention,
    model: &Model,
    log: f64,
    interval: [f64; 2],
) -> Difference {
    let name = convention.name.to_owned();
    let (value, at) = match convention.change {
        Change::Switch { remedy, .. } => {
            return Difference {
                convention: name,
                factor: None,
                interval95: None,
                advice: format!("{}: {remedy}", convention.subject),
            };
        }
        Change::Factor { value, at, .. } => (value, at),
    };
    let interval95 = interval.map(|end| end.exp().clamp(NOTHING, LARGEST));
    let [low, high] = interval95;
    // The numbers follow the factor no further.
    let is_open = high >= LARGEST && low > 1.0;
    let factor = if is_open { low } else { log.exp() };
    let put_in = put_in(value, at, model, factor);
    let words = if is_open {
        let low = significant(low, 3);
        let or_less = if put_in.is_empty() { "" } else { ", or less" };
        format!(
            "at least {low} times that of the model, and these cases do not show how much more{put_in}{or_less}"
        )
    } else {
        let [shown, low, high] = [factor, low, high].map(|x| significant(x, 3));
        let reading = reading(convention, model, log, interval);
        format!("{shown} times ({low} to {high}) that of the model: {reading}{put_in}")
    };
    Difference {
        advice: format!("{} is {words}", convention.subject),
        convention: name,
        factor: Some(factor),
        interval95: Some(interval95),
    }
}

/// What a code with a factor takes, if a known one is near.
fn reading(convention: &Convention, model: &Model, log: f64, interval: [f64; 2]) -> String {
    let error = 0.25 * (interval[1] - interval[0]);
    let near = |known: f64| {
        (known.ln() - log).abs() < NEAR.max(3.0 * error).min(3.0 * NEAR)
            || (known <= NOTHING && log < (2.0 * NOTHING).ln())
    };
    let known = known_readings(convention, model);
    let nearest = known
        .iter()
        .filter(|(known, _)| near(*known))
        .min_by(|a, b| (a.0.ln() - log).abs().total_cmp(&(b.0.ln() - log).abs()));
    nearest.map_or_else(
        || "no convention with this factor is known here".to_owned(),
        |(_, words)| words.clone(),
    )
}

/// The value that makes up for a factor.
fn put_in(value: Value, at: [bool; 2], model: &Model, factor: f64) -> String {
    let places = ["between grains", "at the wall"];
    if factor < 2.0 * NOTHING {
        return String::new();
    }
    let each = (0..2).filter(|&k| at[k]).map(|k| {
        let contact = &model.contacts[k];
        let (what, value) = match value {
            Value::Rolling => ("rolling friction", contact.rolling_friction / factor),
            Value::Friction => ("static friction", contact.static_friction / factor),
            Value::Restitution => (
                "restitution",
                restitution(damping_ratio(contact.restitution) / factor),
            ),
            Value::Cohesion | Value::Modulus | Value::Derived => return None,
        };
        Some(format!("{what} {} {}", significant(value, 3), places[k]))
    });
    let values: Vec<String> = each.flatten().collect();
    match value {
        Value::Derived => String::new(),
        Value::Cohesion => format!(
            "; multiply the attraction by {}",
            significant(1.0 / factor, 3)
        ),
        Value::Modulus => format!("; multiply the moduli by {}", significant(1.0 / factor, 3)),
        _ => format!("; put in {}", values.join(" and ")),
    }
}
