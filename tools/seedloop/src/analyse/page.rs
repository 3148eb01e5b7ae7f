//! The analysis as a page.

use command_line::significant;
use report::{Column, Explorer, Fact, NamedPlace, SliderParameter, Svg, Table, Tone};
use response_surface::Fit;
use study_report::{SurfaceWithSliders, explored_surface};

use super::Report;
use super::text::{counted, fixed, free_of_rounding, largest_coded, probability};

/// Level below which a test counts.
const LEVEL: f64 = 0.05;

/// The analysis as a page that opens offline: the verdict, sliders over the surface, tables, charts, the whole text.
///
/// # Errors
/// What cannot be drawn.
pub(super) fn page(
    report: &Report<'_>,
    text: &str,
    charts: &[(String, Svg)],
) -> Result<String, report::Error> {
    let fit = report.fit;
    let mut page = report::Report::new(format!("Analysis of {}", report.response));
    verdict(&mut page, report);
    explorer(&mut page, report)?;
    page.section("Terms");
    page.table(&terms(fit)?);
    page.section("Pictures");
    for (name, chart) in charts {
        page.figure(chart, &caption(name, fit));
    }
    page.section("Runs").table(&runs(fit)?);
    page.section("The whole analysis as text").verbatim(text);
    page.provenance(&format!("seedloop {}.", report.header.version));
    for (file, hash) in &report.header.inputs {
        page.provenance(&format!("{file}: SHA-256 {hash}"));
    }
    Ok(page.html())
}

/// What the model explains, whether it lacks something, and what to keep in mind.
fn verdict(page: &mut report::Report, report: &Report<'_>) {
    let fit = report.fit;
    let lack = fit.lack_of_fit.as_ref().and_then(|lack| lack.p);
    let (colour, headline) = match (fit.model.p, lack) {
        (None, _) => (
            Tone::Note,
            "The runs leave no degrees of freedom: no term can be tested against residuals.",
        ),
        (Some(p), _) if p >= LEVEL => (Tone::Bad, "The terms explain no more than noise would."),
        (_, Some(p)) if p < LEVEL => (
            Tone::Caution,
            "The terms explain the response in part, and the model lacks something.",
        ),
        (_, Some(_)) => (
            Tone::Good,
            "The terms explain the response, and nothing indicates a lack of fit.",
        ),
        (_, None) => (
            Tone::Good,
            "The terms explain the response; without repeated runs a lack of fit cannot be tested.",
        ),
    };
    let reason = format!(
        "Model p {}, lack of fit p {}; level {LEVEL}.",
        probability(fit.model.p),
        probability(lack)
    );
    page.section("Verdict").verdict(colour, headline, &reason);
    page.facts(&[
        Fact::new("R²", fixed(fit.r2, 4)),
        Fact::new("R² adjusted", fixed(fit.adj_r2, 4)),
        Fact::new("R² predicted", fixed(fit.pred_r2, 4)),
        Fact::new("Root mean square error", counted(fit.root_mse, 5)),
        Fact::new(
            "Runs and degrees of freedom",
            format!("{} and {}", fit.n, fit.df_resid),
        ),
    ]);
    if !report.warning_texts.is_empty() {
        let warnings: Vec<&str> = report.warning_texts.iter().map(String::as_str).collect();
        page.paragraph("What to keep in mind:").list(&warnings);
    }
}

/// Sliders over the polynomial; nothing where factors have named levels, whose columns are not settings.
fn explorer(page: &mut report::Report, report: &Report<'_>) -> Result<(), report::Error> {
    let fit = report.fit;
    let begin: Vec<f64> = fit
        .factors
        .iter()
        .map(experiment_design::Factor::mid)
        .collect();
    let surface = explored_surface(SurfaceWithSliders {
        name: report.response.to_owned(),
        unit: "",
        fit,
        sliders: (0..fit.factors.len()).collect(),
        begin: begin.clone(),
        measured: None,
    });
    let Some(surface) = surface.filter(|_| report.categories.is_empty()) else {
        return Ok(());
    };
    page.section("Try other settings");
    if report.gaussian_process.is_some() {
        page.paragraph("The sliders move the polynomial, not the Gaussian process.");
    }
    let parameters = fit.factors.iter().map(|f| SliderParameter {
        symbol: f.symbol().to_owned(),
        name: f.name().to_owned(),
        unit: unit(f.unit()),
        low: f.low(),
        high: f.high(),
    });
    let explorer = Explorer {
        parameters: parameters.collect(),
        places: vec![NamedPlace {
            name: "middle".to_owned(),
            values: begin,
        }],
        surfaces: vec![surface],
    };
    page.explorer(
        &explorer,
        "What the polynomial predicts, with 95 % intervals of the mean (dark) and of a new row (light), by the residuals.",
    )?;
    Ok(())
}

/// Coefficients with their tests.
fn terms(fit: &Fit) -> Result<Table, report::Error> {
    let columns = [
        "coefficient, coded",
        "standard error",
        "sum of squares",
        "F",
        "p",
        "%",
    ];
    let columns = columns.map(Column::number).into_iter();
    let columns = std::iter::once(Column::text("term"))
        .chain(columns)
        .collect();
    let mut table = Table::new("Terms in coded units, partial sums of squares.", columns)?;
    let largest = largest_coded(fit);
    for (name, row) in fit.terms.iter() {
        table.row([
            fit.formula.printed(name),
            significant(free_of_rounding(row, 1.0, largest), 6),
            counted(row.se, 4),
            counted(row.ss_partial, 5),
            counted(row.f, 4),
            probability(row.p),
            fixed(row.contribution_pct, 3),
        ])?;
    }
    Ok(table)
}

/// Every row of the data with its residual.
fn runs(fit: &Fit) -> Result<Table, report::Error> {
    let columns = [
        "run",
        "actual",
        "fitted",
        "residual",
        "leverage",
        "external studentised",
        "Cook's D",
    ];
    let columns = columns.map(Column::number).into();
    let mut table = Table::new("Runs with their residuals.", columns)?;
    for case in &fit.cases {
        table.row([
            case.run.to_string(),
            case.actual.to_string(),
            significant(case.fitted, 6),
            significant(case.residual, 4),
            format!("{:.4}", case.leverage),
            fixed(case.studentized_external, 3),
            counted(case.cooks_d, 4),
        ])?;
    }
    Ok(table)
}

/// What a chart shows; of pairs and cubes also where the other factors are held.
fn caption(name: &str, fit: &Fit) -> String {
    let kinds = [
        "contour-",
        "surface-",
        "interaction-",
        "cube-",
        "perturbation",
    ];
    if !kinds.iter().any(|kind| name.starts_with(kind)) {
        return format!("{}.", name.replace('-', " "));
    }
    let shown: Vec<&str> = name.split('-').skip(1).collect();
    let others = fit.factors.iter().filter(|f| !shown.contains(&f.symbol()));
    let held: Vec<String> = others
        .map(|f| {
            format!(
                "{} = {} {}",
                f.symbol(),
                significant(f.mid(), 4),
                unit(f.unit())
            )
        })
        .map(|text| text.trim_end().to_owned())
        .collect();
    let words = name.replace('-', " ");
    match (name.starts_with("perturbation"), held.is_empty()) {
        (true, _) => format!(
            "{words}: one factor at a time, the others at {}.",
            held.join(", ")
        ),
        (_, true) => format!("{words}."),
        _ => format!("{words}; held: {}.", held.join(", ")),
    }
}

/// A unit as it is shown: none for a plain number.
fn unit(unit: &str) -> String {
    unit.strip_prefix('1')
        .filter(|rest| rest.is_empty())
        .unwrap_or(unit)
        .to_owned()
}
