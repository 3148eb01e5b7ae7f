//! The response surface and the set of solutions.

use super::Page;
use super::numbers::{
    DASH, counted, degrees, digits, digits_or_dash, fixed, fixed_or_dash, p_in_words, p_value,
    signed,
};
use super::pictures::surface_chart::strongest_two;
use super::published_surface::PublishedSurface;
use crate::Error;
use report::{Column, Table};
use response_surface::ErrorSource;

/// Adds the section.
pub(super) fn add(page: &mut Page<'_>) -> Result<(), Error> {
    let result = page.result;
    let fit = &result.surface.fit;
    let n_runs: usize = result.surface.cells.iter().map(|c| c.responses.len()).sum();
    page.report
        .section("Response surface (Box-Behnken)")
        .paragraph(&format!(
            "{} cells, {}. Factors: {}. The model has all terms up to degree two.",
            fit.n,
            counted(n_runs, "run", "runs"),
            fit.formula.symbols().join(", "),
        ));
    page.report.paragraph(&format!(
        "Fitted over coded factors (−1 to +1), °: {}.",
        equation(page)
    ));
    anova(page)?;
    quality(page);
    contour(page);
    solutions(page)
}

/// The equation in coded units.
fn equation(page: &Page<'_>) -> String {
    let mut text = String::from("θ =");
    for (name, row) in page.result.surface.fit.terms.iter() {
        let term = if name == "1" {
            String::new()
        } else {
            format!(" {name}")
        };
        text.push_str(&format_term(row.coef, &term, text.ends_with('=')));
    }
    text
}

/// A term with its sign.
fn format_term(coefficient: f64, term: &str, first: bool) -> String {
    let size = fixed(coefficient.abs(), 2);
    match (first, coefficient < 0.0) {
        (true, false) => format!(" {size}{term}"),
        (true, true) => format!(" −{size}{term}"),
        (false, false) => format!(" + {size}{term}"),
        (false, true) => format!(" − {size}{term}"),
    }
}

/// The analysis of variance.
fn anova(page: &mut Page<'_>) -> Result<(), Error> {
    let fit = &page.result.surface.fit;
    let mut table = Table::new(
        "Analysis of variance of the surface: coefficients in coded units with standard errors, \
         partial sums of squares, F against the residuals.",
        vec![
            Column::text("source"),
            Column::number("coefficient (°)"),
            Column::number("standard error (°)"),
            Column::number("sum of squares (°²)"),
            Column::number("df"),
            Column::number("F"),
            Column::number("p"),
        ],
    )?;
    let dash = || DASH.to_owned();
    let model = &fit.model;
    table.row([
        "model".to_owned(),
        dash(),
        dash(),
        fixed(model.ss, 2),
        model.df.to_string(),
        fixed_or_dash(model.f, 2),
        p_value(model.p),
    ])?;
    for (name, row) in fit.terms.iter() {
        table.row([
            name.to_owned(),
            signed(row.coef, 3),
            fixed_or_dash(row.se, 3),
            fixed_or_dash(row.ss_partial, 3),
            "1".to_owned(),
            fixed_or_dash(row.f, 2),
            p_value(row.p),
        ])?;
    }
    let mut rest = vec![("residual", Some(fit.sse), fit.df_resid, None, None)];
    match &fit.lack_of_fit {
        Some(lack) => rest.push(("lack of fit", Some(lack.ss), lack.df, lack.f, lack.p)),
        None => rest.push(("lack of fit", None, 0, None, None)),
    }
    if let Some(pure) = &fit.pure_error {
        rest.push(("pure error", Some(pure.ss), pure.df, None, None));
    }
    for (source, ss, df, f, p) in rest {
        let df = if ss.is_some() { df.to_string() } else { dash() };
        let (ss, f) = (fixed_or_dash(ss, 3), fixed_or_dash(f, 2));
        table.row([source.to_owned(), dash(), dash(), ss, df, f, p_value(p)])?;
    }
    page.report.table(&table);
    Ok(())
}

/// How well the surface stands for the cells.
fn quality(page: &mut Page<'_>) {
    let fit = &page.result.surface.fit;
    let lack = match &fit.lack_of_fit {
        Some(lack) => format!(
            "Lack of fit against repeated centre cells: F = {} ({}, {} degrees of freedom), {}.",
            fixed_or_dash(lack.f, 2),
            lack.df,
            fit.pure_error.as_ref().map_or(0, |pure| pure.df),
            p_in_words(lack.p)
        ),
        None => "Lack of fit against repeated centre cells: undefined, there are none.".to_owned(),
    };
    let within = fit
        .replicates
        .as_ref()
        .and_then(|r| r.lack_of_fit_vs_replicates.as_ref());
    let replicates = match within {
        Some(test) => format!(
            "Against the replicates within cells: F = {} ({}, {} degrees of freedom), {}.",
            fixed_or_dash(test.f, 2),
            test.df1,
            test.df2,
            p_in_words(test.p)
        ),
        None => "Against replicates within cells: undefined, no replicates.".to_owned(),
    };
    page.report.paragraph(&format!(
        "R² = {}, adjusted {}, predicted {}; root mean square error {}° with {} degrees of freedom. \
         {lack} {replicates}",
        fixed_or_dash(fit.r2, 4),
        fixed_or_dash(fit.adj_r2, 4),
        fixed_or_dash(fit.pred_r2, 4),
        fixed_or_dash(fit.root_mse, 3),
        fit.df_resid,
    ));
    let warnings: Vec<String> = fit.warnings.iter().map(ToString::to_string).collect();
    if !warnings.is_empty() {
        let warnings: Vec<&str> = warnings.iter().map(String::as_str).collect();
        page.report
            .paragraph("Warnings of the fit:")
            .list(&warnings);
    }
}

/// The picture.
fn contour(page: &mut Page<'_>) {
    let (fit, result) = (&page.result.surface.fit, page.result);
    let shown = strongest_two(fit).unwrap_or_default();
    let held: Vec<String> = fit
        .factors
        .iter()
        .enumerate()
        .filter(|(k, _)| !shown.contains(k))
        .map(|(_, f)| {
            let value = result.chosen.get(f.symbol()).copied().unwrap_or(f.mid());
            format!("{} = {}", f.symbol(), digits(value))
        })
        .collect();
    let held = if held.is_empty() {
        String::new()
    } else {
        format!(" at {}", held.join(", "))
    };
    page.chart(
        "surface",
        &format!(
            "Fitted angle over the two strongest factors{held}. Bold: solutions for the measured \
             angle. Shaded: points that the data cannot tell from a solution (95 %). Marked points \
             are shown by their values of the two factors alone; those outside of the bounds are \
             left out."
        ),
    );
}

/// The set of solutions.
fn solutions(page: &mut Page<'_>) -> Result<(), Error> {
    let (study, result) = (page.study, page.result);
    let set = &result.solutions;
    page.report.subsection("Solutions for the measured angle");
    let target = &study.target;
    page.report.paragraph(&format!(
        "Target: {}, standard error {}°. Within the bounds the surface reaches {}° to {}°. {}",
        degrees(target.value, Some(target.sd), target.n),
        fixed_or_dash(set.target_se, 2),
        fixed(set.reachable.min.value, 2),
        fixed(set.reachable.max.value, 2),
        if set.exists {
            "The solutions form a set, not a point: one angle is one equation."
        } else {
            "The target lies outside: there is no solution, and the chosen point is the nearest \
             that the surface reaches."
        },
    ));
    page.report.paragraph(&region(page));
    table(page)?;
    published(page);
    Ok(())
}

/// The share of the bounds that the data cannot tell from a solution.
fn region(page: &Page<'_>) -> String {
    let set = &page.result.solutions;
    let (Some(region), Some(error)) = (&set.region, set.error) else {
        return "The region of points not told from a solution is undefined: there is no error \
                variance."
            .into();
    };
    let source = match error.source {
        ErrorSource::Residual => "residuals of the fit",
        ErrorSource::RepeatedRows => "repeated centre cells",
        ErrorSource::Replicates => "replicates within cells",
        ErrorSource::AllRepeats => "all repeats",
    };
    format!(
        "{} % ± {} % (standard error of the sampling) of the volume of the bounds cannot be told \
         from a solution at 95 %. Error of a cell: {}°, from {source}, {}.",
        fixed(100.0 * region.box_fraction, 1),
        fixed(100.0 * region.box_fraction_se, 1),
        fixed(error.variance.sqrt(), 3),
        counted(error.df, "degree of freedom", "degrees of freedom"),
    )
}

/// Factors: bounds, solutions, chosen value.
fn table(page: &mut Page<'_>) -> Result<(), Error> {
    let (study, result) = (page.study, page.result);
    let mut table = Table::new(
        "Factors of the surface on the set of solutions; all values are dimensionless. The region \
         of one factor holds the others at the chosen point.",
        vec![
            Column::text("factor"),
            Column::number("bench mean ± sd (n)"),
            Column::number("bounds"),
            Column::number("on the solutions"),
            Column::number("chosen"),
            Column::number("region at 95 %, others held"),
            Column::number("chosen − bench (sd)"),
        ],
    )?;
    let nearest = result.solutions.nearest.get("sd");
    for f in &result.surface.fit.factors {
        let entry = study.factor(f.symbol())?;
        let m = entry.measured;
        let interval = |low: f64, high: f64| format!("{} to {}", fixed(low, 3), fixed(high, 3));
        let range = result
            .solutions
            .factor_ranges
            .as_ref()
            .and_then(|r| r.get(f.symbol()));
        let region = nearest.and_then(|n| n.given_others.as_ref()?.get(f.symbol()));
        let chosen = result.chosen.get(f.symbol()).copied();
        table.row([
            format!("{} {}", f.symbol(), f.name()),
            format!("{} ± {} ({})", fixed(m.mean, 2), fixed(m.sd, 2), m.n),
            interval(f.low(), f.high()),
            range.map_or_else(
                || DASH.to_owned(),
                |r| interval(r.natural.low, r.natural.high),
            ),
            fixed_or_dash(chosen, 4),
            region.map_or_else(
                || DASH.to_owned(),
                |r| {
                    let mark = |open: bool| if open { "*" } else { "" };
                    let (low, high) = (fixed(r.natural.low, 3), fixed(r.natural.high, 3));
                    format!(
                        "{low}{} to {high}{}",
                        mark(r.open_below),
                        mark(r.open_above)
                    )
                },
            ),
            chosen.map_or_else(|| DASH.to_owned(), |c| signed((c - m.mean) / m.sd, 1)),
        ])?;
    }
    page.report.table(&table);
    page.report.paragraph(
        "An end with * is cut at the bound of the factor: the data give no limit on that side.",
    );
    Ok(())
}

/// What the published regression and our surface say of the published optimum.
fn published(page: &mut Page<'_>) {
    let (study, result) = (page.study, page.result);
    let value = |symbol: &str| study.published_optimum.get(symbol).copied();
    let theirs = PublishedSurface::of(study).and_then(|p| p.angle_deg(&value));
    let fit = &result.surface.fit;
    // Parameters that the published optimum does not name are at their bench means in the study.
    let bench = |symbol: &str| study.factor(symbol).ok().map(|f| f.measured.mean);
    let all = |symbol: &str| value(symbol).or_else(|| bench(symbol));
    let point: Option<Vec<f64>> = fit.factors.iter().map(|f| all(f.symbol())).collect();
    let ours = point.and_then(|p| fit.predict(&p).ok());
    let optimum = &result.published_optimum;
    page.report.paragraph(&format!(
        "At the published optimum: eq. (10) of the study gives {}° (its target was {}°); \
         our surface gives {}° (standard error {}°); our runs give {}.",
        theirs.map_or_else(|| DASH.to_owned(), |t| fixed(t, 2)),
        fixed(study.target.value, 2),
        ours.as_ref()
            .map_or_else(|| DASH.to_owned(), |p| fixed(p.mean, 2)),
        digits_or_dash(ours.and_then(|p| p.se_mean)),
        degrees(optimum.mean, optimum.sd, optimum.n),
    ));
}
