//! Tables of measurements and of single runs.

use super::csv::{CsvTable, Field};
use super::{parameter_column, unit_of, with_unit};
use crate::ReportInput;
use crate::measurement_rows::{condition_text, role_name, rows};
use campaign::run_store::Record;
use inference::{Comparison, Role};
use std::collections::{BTreeMap, BTreeSet};

/// Every measurement, and what was simulated before and after.
pub(super) fn measurements(input: &ReportInput<'_>) -> CsvTable {
    let head = ["scene", "condition", "observable", "unit", "role"];
    let measured = ["measured_mean", "measured_sd", "measured_n", "measured_se"];
    let simulated = ["mean", "se", "runs", "z_1"];
    let tail = ["parameter_se", "z_limit_1", "holds", "regimes", "run_keys"];
    let columns: Vec<String> = head
        .into_iter()
        .chain(measured)
        .map(String::from)
        .chain(simulated.map(|name| format!("before_{name}")))
        .chain(simulated.map(|name| format!("after_{name}")))
        .chain(tail.map(String::from))
        .collect();
    let mut table = CsvTable::new("measurements", columns);
    for row in rows(input) {
        let m = row.measurement;
        let mut fields: Vec<Field> = vec![
            (&row.model.scene).into(),
            (&condition_text(&row.model.condition)).into(),
            (&m.observable).into(),
            unit_of(&m.observable).into(),
            role_name(m.role).into(),
            m.mean.into(),
            m.sd.into(),
            m.n.into(),
            row.measured_se().into(),
        ];
        fields.extend(simulated_mean(row.before));
        fields.extend(simulated_mean(row.after));
        if let Some(after) = row.after {
            let regimes: Vec<String> = after
                .regimes
                .iter()
                .map(|(name, n)| format!("{n} {name}"))
                .collect();
            // What is only shown is not judged.
            let holds = match m.role {
                Role::Show => Field::Empty,
                Role::Fit | Role::Check => after.holds.into(),
            };
            fields.extend([
                after.parameter_se.into(),
                after.z_limit.into(),
                holds,
                (&regimes.join(" ")).into(),
                (&after.keys.join(" ")).into(),
            ]);
        }
        table.row(fields);
    }
    table
}

/// Mean, standard error, number of runs and z of a comparison; empty fields for none.
fn simulated_mean(comparison: Option<&Comparison>) -> [Field; 4] {
    match comparison {
        None => [Field::Empty, Field::Empty, Field::Empty, Field::Empty],
        Some(c) => [
            c.simulated.mean.into(),
            c.simulated.se.into(),
            c.simulated.n_runs.into(),
            c.z.into(),
        ],
    }
}

/// One run as a row: what is not known of it is empty.
struct Run<'a> {
    /// Where it comes from.
    stage: &'a str,
    /// Name of the model.
    model: &'a str,
    /// Seed, as text: it may have more digits than a number keeps.
    seed: Option<u64>,
    /// Values of the parameters by symbol.
    parameters: BTreeMap<&'a str, f64>,
    /// Means of the observables.
    observables: BTreeMap<&'a str, f64>,
    /// Key of its record.
    key: &'a str,
}

/// Every run behind the surfaces of the last box and behind the comparisons.
pub(super) fn runs(input: &ReportInput<'_>) -> CsvTable {
    let mut all = surface_runs(input);
    let of_surfaces: BTreeSet<&str> = all.iter().map(|run| run.key).collect();
    let others = input.records.iter();
    let others = others.filter(|(key, _)| !of_surfaces.contains(key.as_str()));
    all.extend(others.map(|(_, record)| of_record(record)));
    let symbols = input.calibration.parameters.iter();
    let symbols: Vec<(&str, &str)> = symbols
        .map(|p| (p.symbol.as_str(), p.unit.as_str()))
        .collect();
    let names: BTreeSet<&str> = all
        .iter()
        .flat_map(|run| run.observables.keys().copied())
        .collect();
    let columns = ["stage", "model", "seed"]
        .map(String::from)
        .into_iter()
        .chain(
            symbols
                .iter()
                .map(|(symbol, unit)| parameter_column(symbol, unit)),
        )
        .chain(names.iter().map(|name| with_unit(name)))
        .chain(["run_key".to_owned()]);
    let mut table = CsvTable::new("runs", columns);
    for run in &all {
        let seed = run
            .seed
            .map_or(Field::Empty, |seed| (&seed.to_string()).into());
        let mut row = vec![Field::from(run.stage), run.model.into(), seed];
        let values = symbols
            .iter()
            .map(|(symbol, _)| run.parameters.get(symbol).copied());
        row.extend(values.map(Field::from));
        let values = names.iter().map(|name| run.observables.get(name).copied());
        row.extend(values.map(Field::from));
        row.push(run.key.into());
        table.row(row);
    }
    table
}

/// The runs that entered the surfaces.
fn surface_runs<'a>(input: &ReportInput<'a>) -> Vec<Run<'a>> {
    let mut runs = Vec::new();
    for s in &input.calibration.surfaces {
        for (k, point) in s.points.iter().enumerate() {
            let at = s
                .symbols
                .iter()
                .map(String::as_str)
                .zip(point.iter().copied());
            let values = s.values.iter();
            let values = values.filter_map(|(name, v)| Some((name.as_str(), *v.get(k)?)));
            let key = s.keys.get(k).map_or("", String::as_str);
            runs.push(Run {
                stage: "surface",
                model: &s.model,
                seed: input.records.get(key).map(Record::seed),
                parameters: at.collect(),
                observables: values.collect(),
                key,
            });
        }
    }
    runs
}

/// The run of a record.
fn of_record(record: &Record) -> Run<'_> {
    let inputs = record.inputs();
    let parameters = inputs["parameters"].as_object();
    let values = parameters.into_iter().flatten();
    let observables = record.observables().iter();
    Run {
        stage: "comparison",
        model: inputs["model"].as_str().unwrap_or_default(),
        seed: Some(record.seed()),
        parameters: values
            .filter_map(|(symbol, x)| Some((symbol.as_str(), x.as_f64()?)))
            .collect(),
        observables: observables
            .map(|(name, o)| (name.as_str(), o.mean))
            .collect(),
        key: record.key(),
    }
}

/// Runs that entered no surface, with the reason.
pub(super) fn left_out(input: &ReportInput<'_>) -> CsvTable {
    let parameters = &input.calibration.parameters;
    let columns = parameters
        .iter()
        .map(|p| parameter_column(&p.symbol, &p.unit));
    let columns = std::iter::once("model".to_owned())
        .chain(columns)
        .chain(["reason".to_owned()]);
    let mut table = CsvTable::new("runs_left_out", columns);
    for s in &input.calibration.surfaces {
        for run in &s.left_out {
            let value = |symbol: &str| {
                let place = s.symbols.iter().position(|known| known == symbol);
                Field::from(place.and_then(|k| run.point.get(k).copied()))
            };
            let values = parameters.iter().map(|p| value(&p.symbol));
            table.row(
                std::iter::once(Field::from(&s.model))
                    .chain(values)
                    .chain([(&run.reason).into()]),
            );
        }
    }
    table
}
