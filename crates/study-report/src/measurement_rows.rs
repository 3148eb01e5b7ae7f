//! Every measurement beside what was simulated before and after.

use crate::ReportInput;
use inference::{Comparison, Measurement, Model, Role, WithEffects};
use std::collections::BTreeMap;

/// A measurement with its comparisons.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MeasurementRow<'a> {
    /// The measured value.
    pub(crate) measurement: &'a Measurement,
    /// Where.
    pub(crate) model: &'a Model,
    /// With the parameters in use before; `None` if that was left out.
    pub(crate) before: Option<&'a Comparison>,
    /// At the estimate; `None` if no run gave it.
    pub(crate) after: Option<&'a Comparison>,
    /// With the effects that are named; `None` if nothing is, or the measurement is only shown.
    pub(crate) with_effects: Option<&'a Comparison>,
}

impl MeasurementRow<'_> {
    /// Standard error of the measured mean, in the unit of the observable.
    pub(crate) fn measured_se(&self) -> f64 {
        self.measurement.variance().sqrt()
    }
}

/// All measurements: those of the fit, then the checks, then what is only shown, each in the order of the file.
pub(crate) fn rows<'a>(input: &ReportInput<'a>) -> Vec<MeasurementRow<'a>> {
    let (problem, found) = (input.problem, input.calibration);
    let with = found.with_effects.as_ref();
    let of = |role: Role| match role {
        Role::Fit => &found.fit,
        Role::Check => &found.check,
        Role::Show => &found.show,
    };
    let row = |i: usize| {
        let measurement = &problem.measurements[i];
        let model = problem.models.get(measurement.model)?;
        let meant = |c: &&Comparison| {
            c.role == measurement.role
                && c.observable == measurement.observable
                && c.scene == model.scene
                && c.condition == model.condition
        };
        Some(MeasurementRow {
            measurement,
            model,
            before: found.before.iter().find(meant),
            after: of(measurement.role).iter().find(meant),
            with_effects: with.and_then(|with| with.rows.iter().find(meant)),
        })
    };
    let numbers = ROLES
        .into_iter()
        .flat_map(|role| problem.measurements_of(role));
    numbers.filter_map(row).collect()
}

/// The effects of a model in words.
pub(crate) fn effects_of(with: &WithEffects) -> String {
    let names: Vec<&str> = with.effects.keys().map(String::as_str).collect();
    names.join(" and ")
}

/// The roles in the order of the report.
pub(crate) const ROLES: [Role; 3] = [Role::Fit, Role::Check, Role::Show];

/// A role in one word.
pub(crate) fn role_name(role: Role) -> &'static str {
    match role {
        Role::Fit => "fit",
        Role::Check => "check",
        Role::Show => "show",
    }
}

/// A scene under a condition, for the page: settings go by the last part of their path.
pub(crate) fn place(scene: &str, condition: &BTreeMap<String, String>) -> String {
    if condition.is_empty() {
        return scene.to_owned();
    }
    let setting = |(path, value): (&String, &String)| {
        let name = path.rsplit('.').next().unwrap_or(path);
        format!("{} {value}", name.replace('_', " "))
    };
    let settings: Vec<String> = condition.iter().map(setting).collect();
    format!("{scene}, {}", settings.join(", "))
}

/// Root mean square of z over the comparisons that are there; none without any.
pub(crate) fn root_mean_square_z<'a>(
    comparisons: impl Iterator<Item = Option<&'a Comparison>>,
) -> Option<f64> {
    let squares: Vec<f64> = comparisons.flatten().map(|c| c.z * c.z).collect();
    let n = squares.len() as f64;
    (n > 0.0).then(|| (squares.iter().sum::<f64>() / n).sqrt())
}
