//! Tables of the surfaces and of the screenings, a row for each coefficient or effect.

use super::csv::{CsvTable, Field};
use super::unit_of;
use crate::ReportInput;

/// Coefficients of all surfaces with their tests; coded units run from -1 to +1 over the box.
pub(super) fn surfaces(input: &ReportInput<'_>) -> CsvTable {
    let columns = [
        "model",
        "observable",
        "unit",
        "term",
        "coefficient_coded",
        "se_coded",
        "ci95_low_coded",
        "ci95_high_coded",
        "sum_of_squares",
        "f_1",
        "p_1",
        "coefficient_natural",
        "residual_df",
        "root_mean_square_error",
    ];
    let mut table = CsvTable::new("surfaces", columns);
    for s in &input.calibration.surfaces {
        let analysed = s.fits.iter();
        for (quantity, fit) in analysed.filter_map(|(q, fit)| Some((q, fit.as_ref()?))) {
            for (term, row) in fit.terms.iter() {
                let [low, high] = row
                    .ci95
                    .map_or([None, None], |[low, high]| [Some(low), Some(high)]);
                table.row([
                    Field::from(&s.model),
                    quantity.into(),
                    unit_of(quantity).into(),
                    term.into(),
                    row.coef.into(),
                    row.se.into(),
                    low.into(),
                    high.into(),
                    row.ss_partial.into(),
                    row.f.into(),
                    row.p.into(),
                    fit.coef_natural_units.get(term).copied().into(),
                    fit.df_resid.into(),
                    fit.root_mse.into(),
                ]);
            }
        }
    }
    table
}

/// Effects of all screenings with their significance.
pub(super) fn screenings(input: &ReportInput<'_>) -> CsvTable {
    let columns = [
        "model",
        "observable",
        "unit",
        "symbol",
        "rank",
        "effect",
        "contribution_percent",
        "p_dummies_1",
        "p_replicates_1",
        "kept",
    ];
    let mut table = CsvTable::new("screenings", columns);
    for s in &input.calibration.screening {
        for (quantity, screening) in &s.screenings {
            for f in &screening.factors {
                table.row([
                    Field::from(&s.model),
                    quantity.into(),
                    unit_of(quantity).into(),
                    (&f.factor).into(),
                    f.rank.into(),
                    f.effect.into(),
                    f.contribution_pct.into(),
                    f.p_dummies.into(),
                    f.p_replicates.into(),
                    s.kept.contains(&f.factor).into(),
                ]);
            }
        }
    }
    table
}
