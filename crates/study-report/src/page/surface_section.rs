//! The response surfaces of the last box.

use super::Page;
use crate::Error;
use crate::numbers::{DASH, digits, fixed_or_dash, in_unit, observable, p_in_words, p_value};
use crate::pictures::surface_charts::{chart, estimate_of, strongest_two};
use inference::ModelSurfaces;
use report::{Column, Table, counted};
use response_surface::Fit;
use response_surface::fit::TermRow;

/// Adds the section; nothing without surfaces.
pub(super) fn add(page: &mut Page<'_>) -> Result<(), Error> {
    let surfaces = &page.input.calibration.surfaces;
    if surfaces.is_empty() {
        return Ok(());
    }
    page.report.section("Response surfaces").paragraph(
        "The surfaces of the last box, one for each observable of each model. Coefficients are in coded units: each \
         parameter runs from −1 to +1 over the box.",
    );
    for (number, model) in surfaces.iter().enumerate() {
        page.report.subsection(&model.model).paragraph(&format!(
            "Design: {}. Parameters: {}. {} entered, {} left out.",
            model.design,
            model.symbols.join(", "),
            counted(model.n_runs, "run", "runs"),
            model.left_out.len()
        ));
        for (quantity, fit) in &model.fits {
            match fit {
                Some(fit) => {
                    of_observable(page, number, quantity, fit)?;
                    shift(page, quantity, model.shifts.get(quantity));
                }
                None => too_few(page, model, quantity),
            }
        }
    }
    Ok(())
}

/// By how much fresh runs have shifted the surface, if they have.
fn shift(page: &mut Page<'_>, quantity: &str, shift: Option<&f64>) {
    if let Some(shift) = shift.filter(|shift| **shift != 0.0) {
        let shift = in_unit(&digits(*shift), observable(quantity).1);
        page.report.paragraph(&format!(
            "The surface includes a shift of {shift}, by which it meets the fresh runs at the estimate; the sums of squares are those of \
             the design."
        ));
    }
}

/// Text instead of an analysis that the runs do not give.
fn too_few(page: &mut Page<'_>, model: &ModelSurfaces, quantity: &str) {
    let words = observable(quantity).0;
    let n = counted(model.n_runs, "run", "runs");
    page.report.paragraph(&format!(
        "The {words} has no analysis of variance: {n} are too few for one."
    ));
}

/// One surface.
fn of_observable(
    page: &mut Page<'_>,
    number: usize,
    quantity: &str,
    fit: &Fit,
) -> Result<(), Error> {
    let (words, unit) = observable(quantity);
    page.report
        .paragraph(&format!("{}.", equation(&words, unit, fit)));
    let caption = match strongest_two(fit) {
        None => format!(
            "The {words} over the parameter: means of the runs at each level, the fitted curve, and what was measured."
        ),
        Some(shown) => format!(
            "Fitted {words} over the two parameters that move it most{}. Bold: points that give the measured value. \
             Shaded: points that are not told from it. Squares: runs of the design; those of one place differ in other \
             parameters, and a click opens them.",
            held(page, fit, shown)
        ),
    };
    let drawn = chart(page.input, number, quantity, fit)?;
    page.chart(Some(&drawn), &caption)?;
    quality(page, unit, fit);
    anova(page, &words, unit, fit)
}

/// The parameters that a picture holds at the estimate.
fn held(page: &Page<'_>, fit: &Fit, shown: [usize; 2]) -> String {
    let values = estimate_of(page.input, fit);
    let held: Vec<String> = fit
        .factors
        .iter()
        .zip(values)
        .enumerate()
        .filter(|(k, _)| !shown.contains(k))
        .map(|(_, (f, value))| {
            let value = in_unit(&digits(value), f.unit());
            format!("{} = {value}", f.symbol())
        })
        .collect();
    if held.is_empty() {
        String::new()
    } else {
        format!(", with {} held there", held.join(", "))
    }
}

/// The equation in coded units.
fn equation(words: &str, unit: &str, fit: &Fit) -> String {
    let unit = if unit.is_empty() { "1" } else { unit };
    let term = |(k, (name, row)): (usize, (&str, &TermRow))| {
        let sign = match (k, row.coef < 0.0) {
            (0, false) => "",
            (0, true) => "−",
            (_, false) => "+ ",
            (_, true) => "− ",
        };
        let name = if name == "1" {
            String::new()
        } else {
            format!(" {}", fit.formula.printed(name))
        };
        format!("{sign}{}{name}", digits(row.coef.abs()))
    };
    let terms: Vec<String> = fit.terms.iter().enumerate().map(term).collect();
    format!("{words} ({unit}) = {}", terms.join(" "))
}

/// How well the surface describes the runs.
fn quality(page: &mut Page<'_>, unit: &str, fit: &Fit) {
    let lack = match &fit.lack_of_fit {
        Some(lack) => format!(
            "Lack of fit against repeated points: F = {} ({}, {} degrees of freedom), {}.",
            fixed_or_dash(lack.f, 2),
            lack.df,
            fit.pure_error.as_ref().map_or(0, |pure| pure.df),
            p_in_words(lack.p)
        ),
        None => "Lack of fit against repeated points: undefined.".to_owned(),
    };
    let within = fit.replicates.as_ref();
    let within = within.and_then(|r| r.lack_of_fit_vs_replicates.as_ref());
    let replicates = within.map_or_else(String::new, |test| {
        format!(
            " Against the replicates within cells: F = {} ({}, {} degrees of freedom), {}.",
            fixed_or_dash(test.f, 2),
            test.df1,
            test.df2,
            p_in_words(test.p)
        )
    });
    let error = fit
        .root_mse
        .map_or_else(|| DASH.to_owned(), |e| in_unit(&digits(e), unit));
    page.report.paragraph(&format!(
        "R² = {}, adjusted {}, predicted {}; root mean square error {error} with {}. {lack}{replicates}",
        fixed_or_dash(fit.r2, 4),
        fixed_or_dash(fit.adj_r2, 4),
        fixed_or_dash(fit.pred_r2, 4),
        counted(fit.df_resid, "degree of freedom", "degrees of freedom"),
    ));
    let warnings: Vec<String> = fit.warnings.iter().map(ToString::to_string).collect();
    super::list(&mut page.report, "Warnings of the fit:", &warnings);
}

/// The analysis of variance.
fn anova(page: &mut Page<'_>, words: &str, unit: &str, fit: &Fit) -> Result<(), Error> {
    let unit = if unit.is_empty() { "1" } else { unit };
    let square = if unit == "1" {
        "1".to_owned()
    } else {
        format!("{unit}²")
    };
    let mut table = Table::new(
        format!(
            "Analysis of variance of the {words}: coefficients with standard errors, partial sums of squares, F \
             against the residuals."
        ),
        vec![
            Column::text("source"),
            Column::number(format!("coefficient ({unit})")),
            Column::number(format!("standard error ({unit})")),
            Column::number(format!("sum of squares ({square})")),
            Column::number("df"),
            Column::number("F"),
            Column::number("p"),
        ],
    )?;
    let dash = || DASH.to_owned();
    for (name, row) in fit.terms.iter() {
        table.row([
            fit.formula.printed(name),
            digits(row.coef),
            row.se.map_or_else(dash, digits),
            row.ss_partial.map_or_else(dash, digits),
            "1".to_owned(),
            fixed_or_dash(row.f, 2),
            p_value(row.p),
        ])?;
    }
    sums_of_squares(&mut table, fit)?;
    page.table(&table);
    Ok(())
}

/// The rows of the analysis that are not terms.
fn sums_of_squares(table: &mut Table, fit: &Fit) -> Result<(), Error> {
    let dash = || DASH.to_owned();
    let mut rest = vec![
        (
            "model",
            fit.model.ss,
            fit.model.df,
            fit.model.f,
            fit.model.p,
        ),
        ("residual", fit.sse, fit.df_resid, None, None),
    ];
    rest.extend(
        fit.lack_of_fit
            .iter()
            .map(|l| ("lack of fit", l.ss, l.df, l.f, l.p)),
    );
    rest.extend(
        fit.pure_error
            .iter()
            .map(|e| ("pure error", e.ss, e.df, None, None)),
    );
    for (source, ss, df, f, p) in rest {
        let (f, p) = (fixed_or_dash(f, 2), p_value(p));
        table.row([
            source.to_owned(),
            dash(),
            dash(),
            digits(ss),
            df.to_string(),
            f,
            p,
        ])?;
    }
    Ok(())
}
