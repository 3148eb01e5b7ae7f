//! Tables of the designs and of their analysis.

use super::csv::{CsvTable, Field};
use crate::{StudyFile, StudyResult};
use calibration::CellRuns;
use response_surface::Fit;

/// Mean and standard deviation of runs; no standard deviation for one run.
fn mean_and_sd(values: &[f64]) -> [Field; 2] {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    [
        mean.into(),
        (values.len() > 1)
            .then(|| (square / (n - 1.0)).sqrt())
            .into(),
    ]
}

/// Cells of a design: coded settings, mean, sd and n of the angle, and the runs.
fn design(name: &str, columns: &[String], cells: &[CellRuns]) -> CsvTable {
    let heads = columns.iter().map(|c| format!("{c}_coded"));
    let rest = [
        "angle_mean_deg",
        "angle_sd_deg",
        "n_runs",
        "angles_deg",
        "run_keys",
    ];
    let all = std::iter::once("cell".to_owned())
        .chain(heads)
        .chain(rest.map(String::from));
    let mut table = CsvTable::new(name, all);
    for (k, cell) in cells.iter().enumerate() {
        let mut row = vec![Field::from(k + 1)];
        row.extend(cell.coded.iter().map(|x| Field::from(*x)));
        row.extend(mean_and_sd(&cell.responses));
        row.push(cell.responses.len().into());
        let angles: Vec<String> = cell.responses.iter().map(|v| format!("{v:?}")).collect();
        row.push((&angles.join(" ")).into());
        row.push((&cell.keys.join(" ")).into());
        table.row(row);
    }
    table
}

/// The Plackett-Burman design with the dummy columns.
pub(super) fn screening_design(result: &StudyResult) -> CsvTable {
    design(
        "screening_design",
        &result.screening.columns,
        &result.screening.cells,
    )
}

/// Effects of all columns with their significance.
pub(super) fn screening_effects(result: &StudyResult) -> CsvTable {
    let mut table = CsvTable::new(
        "screening_effects",
        [
            "column",
            "kind",
            "rank",
            "effect_deg",
            "contribution_percent",
            "p_dummies_1",
            "p_replicates_1",
            "kept",
        ],
    );
    let screening = &result.screening.screening;
    for f in &screening.factors {
        let kept = result.kept_factors.contains(&f.factor);
        table.row([
            (&f.factor).into(),
            "factor".into(),
            f.rank.into(),
            f.effect.into(),
            f.contribution_pct.into(),
            f.p_dummies.into(),
            f.p_replicates.into(),
            if kept { "yes" } else { "no" }.into(),
        ]);
    }
    let Some(saturated) = &screening.saturated else {
        return table;
    };
    for (name, effect) in saturated.effects.iter() {
        if screening.factors.iter().any(|f| f.factor == name) {
            continue;
        }
        let p = screening
            .replicate_tests
            .as_ref()
            .and_then(|t| t.get(name)?.p);
        table.row([
            name.into(),
            "dummy".into(),
            Field::Empty,
            (*effect).into(),
            saturated.contribution_pct.get(name).copied().into(),
            Field::Empty,
            p.into(),
            "no".into(),
        ]);
    }
    table
}

/// The Box-Behnken design.
pub(super) fn surface_design(result: &StudyResult) -> CsvTable {
    let names: Vec<String> = result
        .surface
        .factors
        .iter()
        .map(|f| f.factor.symbol().to_owned())
        .collect();
    design("surface_design", &names, &result.surface.cells)
}

/// Analysis of variance of the surface with its coefficients.
pub(super) fn surface_anova(result: &StudyResult) -> CsvTable {
    let fit: &Fit = &result.surface.fit;
    let mut table = CsvTable::new(
        "surface_anova",
        [
            "source",
            "coefficient_coded_deg",
            "se_deg",
            "ci95_low_deg",
            "ci95_high_deg",
            "sum_of_squares_deg2",
            "df",
            "mean_square_deg2",
            "f_1",
            "p_1",
            "coefficient_natural_deg",
        ],
    );
    let mut line = |source: &str, ss: Option<f64>, df: usize, f: Option<f64>, p: Option<f64>| {
        let ms = ss.filter(|_| df > 0).map(|ss| ss / df as f64);
        let empty = [Field::Empty, Field::Empty, Field::Empty, Field::Empty];
        let rest = [ss.into(), df.into(), ms.into(), f.into(), p.into()];
        table.row(std::iter::once(source.into()).chain(empty).chain(rest));
    };
    line(
        "model",
        Some(fit.model.ss),
        fit.model.df,
        fit.model.f,
        fit.model.p,
    );
    line("residual", Some(fit.sse), fit.df_resid, None, None);
    if let Some(lack) = &fit.lack_of_fit {
        line("lack of fit", Some(lack.ss), lack.df, lack.f, lack.p);
    }
    if let Some(pure) = &fit.pure_error {
        line("pure error", Some(pure.ss), pure.df, None, None);
    }
    line(
        "total about the mean",
        Some(fit.sst),
        fit.n.saturating_sub(1),
        None,
        None,
    );
    for (name, row) in fit.terms.iter() {
        let [low, high] = row
            .ci95
            .map_or([None, None], |[low, high]| [Some(low), Some(high)]);
        table.row([
            name.into(),
            row.coef.into(),
            row.se.into(),
            low.into(),
            high.into(),
            row.ss_partial.into(),
            1_usize.into(),
            row.ss_partial.into(),
            row.f.into(),
            row.p.into(),
            fit.coef_natural_units.get(name).copied().into(),
        ]);
    }
    table
}

/// The set of solutions: range of each factor, the nearest ones, the chosen one.
pub(super) fn solutions(study: &StudyFile, result: &StudyResult) -> CsvTable {
    let mut table = CsvTable::new(
        "solutions",
        [
            "factor",
            "name",
            "bench_mean_1",
            "bench_sd_1",
            "bench_n",
            "low_level_1",
            "high_level_1",
            "on_solutions_from_1",
            "on_solutions_to_1",
            "nearest_by_sd_1",
            "nearest_by_standard_error_1",
            "nearest_coded_1",
            "chosen_1",
            "chosen_minus_bench_in_sd",
            "published_optimum_1",
        ],
    );
    let set = &result.solutions;
    for entry in &study.factor {
        let place = result
            .surface
            .fit
            .factors
            .iter()
            .position(|f| f.symbol() == entry.symbol);
        let range = set
            .factor_ranges
            .as_ref()
            .and_then(|r| r.get(&entry.symbol));
        let nearest = |metric: &str| -> Field {
            let found = set.nearest.get(metric).zip(place);
            found.and_then(|(n, k)| n.solution.get(k).copied()).into()
        };
        let chosen = result.chosen.get(&entry.symbol).copied();
        table.row([
            (&entry.symbol).into(),
            (&entry.name).into(),
            entry.measured.mean.into(),
            entry.measured.sd.into(),
            entry.measured.n.into(),
            entry.low.into(),
            entry.high.into(),
            range.map(|r| r.natural.low).into(),
            range.map(|r| r.natural.high).into(),
            nearest("sd"),
            nearest("standard_error"),
            nearest("coded"),
            chosen.into(),
            chosen
                .map(|c| (c - entry.measured.mean) / entry.measured.sd)
                .into(),
            study.published_optimum.get(&entry.symbol).copied().into(),
        ]);
    }
    table
}
