//! Tables of the parameters: estimates, correlations, open combinations, solutions, values of others.

use super::csv::{CsvTable, Field};
use super::{parameter_column, unit_of};
use crate::ReportInput;
use inference::Estimate;

/// The parameters, each in its unit, from the fit alone and from all measurements.
pub(super) fn parameters(input: &ReportInput<'_>) -> CsvTable {
    let columns = [
        "symbol",
        "name",
        "unit",
        "value",
        "se",
        "interval95_low",
        "interval95_high",
        "start",
        "limit_low",
        "limit_high",
        "prior_mean",
        "prior_sd",
        "fixed_by_data",
        "at_limit",
        "joint_value",
        "joint_se",
        "joint_interval95_low",
        "joint_interval95_high",
        "sets",
    ];
    let mut table = CsvTable::new("parameters", columns);
    let joint = input.calibration.joint.as_ref();
    for p in &input.calibration.parameters {
        let mut declared = input.problem.parameters.iter();
        let prior = declared
            .find(|d| d.symbol == p.symbol)
            .and_then(|d| d.prior);
        let same = |j: &&Estimate| j.symbol == p.symbol;
        let joint = joint.and_then(|j| j.parameters.iter().find(same));
        table.row([
            (&p.symbol).into(),
            (&p.name).into(),
            (&p.unit).into(),
            p.value.into(),
            p.se.into(),
            p.interval95[0].into(),
            p.interval95[1].into(),
            p.start.into(),
            p.limits[0].into(),
            p.limits[1].into(),
            prior.map(|p| p.mean).into(),
            prior.map(|p| p.sd).into(),
            p.fixed_by_data.into(),
            p.at_limit.into(),
            joint.map(|j| j.value).into(),
            joint.and_then(|j| j.se).into(),
            joint.map(|j| j.interval95[0]).into(),
            joint.map(|j| j.interval95[1]).into(),
            (&p.sets.join(" ")).into(),
        ]);
    }
    table
}

/// A matrix of correlations.
fn matrix(name: &str, parameters: &[Estimate], correlation: &[Vec<f64>]) -> CsvTable {
    let columns = parameters.iter().map(|p| format!("{}_1", p.symbol));
    let columns = std::iter::once("parameter".to_owned()).chain(columns);
    let mut table = CsvTable::new(name, columns);
    for (p, row) in parameters.iter().zip(correlation) {
        let numbers = row.iter().map(|r| Field::from(*r));
        table.row(std::iter::once(Field::from(&p.symbol)).chain(numbers));
    }
    table
}

/// Correlations of the estimates.
pub(super) fn correlations(input: &ReportInput<'_>) -> CsvTable {
    let found = input.calibration;
    matrix("correlations", &found.parameters, &found.correlation)
}

/// Correlations of the joint estimates.
pub(super) fn joint_correlations(input: &ReportInput<'_>) -> CsvTable {
    let joint = input.calibration.joint.as_ref();
    let (parameters, correlation) = joint.map_or((&[][..], &[][..]), |j| {
        (&j.parameters[..], &j.correlation[..])
    });
    matrix("joint_correlations", parameters, correlation)
}

/// Combinations that the measurements leave open: weights in widths of the limits.
pub(super) fn open_combinations(input: &ReportInput<'_>) -> CsvTable {
    let found = input.calibration;
    let columns = found
        .parameters
        .iter()
        .map(|p| format!("weight_{}_1", p.symbol));
    let columns = std::iter::once("combination".to_owned())
        .chain(columns)
        .chain(["se_in_widths_1".to_owned()]);
    let mut table = CsvTable::new("open_combinations", columns);
    for (k, open) in found.open_combinations.iter().enumerate() {
        let weight = |p: &Estimate| Field::from(open.weights.get(&p.symbol).copied());
        let weights = found.parameters.iter().map(weight);
        table.row(
            std::iter::once(Field::from(k + 1))
                .chain(weights)
                .chain([open.se_in_widths.into()]),
        );
    }
    table
}

/// Points of the set of solutions, the separate best ones first.
pub(super) fn solutions(input: &ReportInput<'_>) -> CsvTable {
    let found = input.calibration;
    let columns = found.parameters.iter();
    let columns = columns.map(|p| parameter_column(&p.symbol, &p.unit));
    let columns = std::iter::once("kind".to_owned()).chain(columns);
    let mut table = CsvTable::new("solutions", columns);
    let set = &found.solutions;
    for (kind, points) in [("best", &set.separate), ("drawn", &set.points)] {
        for point in points {
            let values = point.iter().map(|x| Field::from(*x));
            table.row(std::iter::once(Field::from(kind)).chain(values));
        }
    }
    table
}

/// Values of others beside what was found.
pub(super) fn compare(input: &ReportInput<'_>) -> CsvTable {
    let columns = [
        "result", "unit", "found", "found_se", "other", "other_sd", "source",
    ];
    let mut table = CsvTable::new("compare", columns);
    for c in input.compare {
        table.row([
            (&c.result).into(),
            unit_of(&c.result).into(),
            c.found.into(),
            c.se.into(),
            c.value.into(),
            c.sd.into(),
            (&c.source).into(),
        ]);
    }
    table
}
