//! The numbers of the report as CSV tables. The unit of a column stands at the end of its name (`_1` for a plain number);
//! where it differs from row to row, it stands in a column of its own.

mod csv;
mod parameter_tables;
pub(crate) mod residual_tables;
mod run_tables;
mod search_tables;
mod seed_table;
mod surface_tables;

pub(crate) use csv::CsvTable;

use crate::output::DIAGNOSIS;
use crate::unit_of_name::split_unit;
use crate::{Error, ReportInput};
use inference::DiagnosisStage;

/// All tables of a calibration; one that would have no row is left out.
pub(crate) fn tables(input: &ReportInput<'_>) -> Result<Vec<CsvTable>, Error> {
    let mut tables = vec![
        parameter_tables::parameters(input),
        parameter_tables::correlations(input),
        parameter_tables::joint_correlations(input),
        parameter_tables::open_combinations(input),
        parameter_tables::solutions(input),
        parameter_tables::compare(input),
        run_tables::measurements(input),
        run_tables::runs(input),
        run_tables::left_out(input),
        search_tables::boxes(input),
        search_tables::confirmations(input),
        search_tables::cost(input),
        surface_tables::surfaces(input),
        surface_tables::screenings(input),
        seed_table::seeds(input)?,
    ];
    if let DiagnosisStage::Done(study) = &input.calibration.diagnosis {
        let parameters = &input.problem.parameters;
        tables.extend(residual_tables::all(DIAGNOSIS, study, parameters));
    }
    tables.retain(|table| !table.is_empty());
    Ok(tables)
}

/// An observable with its unit: `_1` where the name holds none.
fn with_unit(name: &str) -> String {
    if split_unit(name).is_some() {
        name.to_owned()
    } else {
        format!("{name}_1")
    }
}

/// The unit of an observable as a column holds it: `1` for a plain number.
fn unit_of(name: &str) -> &'static str {
    split_unit(name).map_or("1", |(_, unit)| unit)
}

/// A parameter with its unit, as the name of a column.
fn parameter_column(symbol: &str, unit: &str) -> String {
    let letters = |c: char| if c.is_alphanumeric() { c } else { '_' };
    format!("{symbol}_{}", unit.chars().map(letters).collect::<String>())
}
