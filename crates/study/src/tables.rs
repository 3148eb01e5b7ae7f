//! The numbers of the report as CSV tables.

mod csv;
mod design_tables;
pub(crate) mod residual_tables;
mod run_tables;

pub(crate) use csv::CsvTable;

use crate::{StudyFile, StudyResult};

/// All tables of a study.
pub(crate) fn tables(study: &StudyFile, result: &StudyResult) -> Vec<CsvTable> {
    let mut tables = vec![
        run_tables::fillings(result),
        design_tables::screening_design(result),
        design_tables::screening_effects(result),
        design_tables::surface_design(result),
        design_tables::surface_anova(result),
        design_tables::solutions(study, result),
        run_tables::points(result),
        run_tables::sweep(study, result),
        run_tables::smoothness(result),
    ];
    for (name, residual) in [
        ("bench", &result.residual),
        ("hidden", &result.hidden.study),
        ("nothing_hidden", &result.nothing_hidden.study),
    ] {
        tables.extend(residual_tables::all(name, residual));
    }
    tables
}
