//! The residual that remains at the bench measurements.

use super::Page;
use super::numbers::{DASH, counted, degrees, digits_or_dash, fixed, fixed_or_dash, signed};
use super::point_sections::sweep_table;
use super::residual_parts;
use crate::Error;

/// Adds the section.
pub(super) fn add(page: &mut Page<'_>) -> Result<(), Error> {
    let study = &page.result.residual;
    page.report.section("Residual at the bench measurements");
    what_can_be_tested(page);
    friction(page)?;
    run_at_bench_values(page);
    residual_parts::verdict(&mut page.report, study);
    residual_parts::parameters(&mut page.report, study)?;
    residual_parts::candidates(&mut page.report, study)?;
    page.report.paragraph(&match residual_parts::added(study) {
        Some(effect) => format!(
            "Added to the model: {effect}. The errors before and after are of real runs. With one \
             observation and priors, any effect that moves the angle can take the residual: a \
             smaller error here is no evidence for it."
        ),
        None => residual_parts::not_added(study).to_owned(),
    });
    residual_parts::errors(&mut page.report, study)?;
    let n_kept = study.plan.conditions.iter().filter(|c| !c.used).count();
    if n_kept == 0 {
        page.report.paragraph(
            "There is no kept condition in the study's data: the angle was measured at one speed \
             and one filling. What an effect does outside of the data it was fitted to cannot be \
             checked here; the next two sections check it on data made for that.",
        );
    }
    smoothness(page)
}

/// Degrees of freedom.
fn what_can_be_tested(page: &mut Page<'_>) {
    let study = &page.result.residual;
    let observed =
        study.plan.conditions.iter().filter(|c| c.used).count() * study.plan.observables.len();
    let parameters = study.plan.declared.len();
    let priors = study
        .plan
        .declared
        .iter()
        .filter(|d| d.prior.is_some())
        .count();
    let text = format!(
        "{} and {}: with free parameters this tests nothing, because they take up any angle within \
         their reach. Taken with the bench measurements as priors ({priors} more observations), {} \
         left: whether the bench values and the drum agree can be tested, and nothing more. Which \
         effect is missing cannot be told from one number.",
        counted(observed, "measured number", "measured numbers"),
        counted(parameters, "declared parameter", "declared parameters"),
        match study.diagnosis.structured_residual.df {
            1 => "one degree of freedom is".to_owned(),
            n => format!("{n} degrees of freedom are"),
        },
    );
    page.report.paragraph(&text);
}

/// How far the calibration moves the swept parameter from its bench value.
fn friction(page: &mut Page<'_>) -> Result<(), Error> {
    let factor = page.study.factor(&page.study.sweep.symbol)?;
    let m = factor.measured;
    let Some(chosen) = page.result.chosen.get(&factor.symbol).copied() else {
        return Ok(());
    };
    let shift = (m.mean - chosen) / m.sd;
    let meaning = if shift.abs() > 2.0 {
        " A parameter moved this far no longer means what was measured on the bench."
    } else {
        ""
    };
    page.report.paragraph(&format!(
        "The calibration wants {} = {} for the {}; the bench gives {} ± {} (sd, n = {}). Bench \
         minus calibration: {} standard deviations of single bench measurements.{meaning}",
        factor.symbol,
        fixed(chosen, 4),
        factor.name,
        fixed(m.mean, 2),
        fixed(m.sd, 2),
        m.n,
        signed(shift, 1),
    ));
    Ok(())
}

/// The angle with all parameters at their bench values.
fn run_at_bench_values(page: &mut Page<'_>) {
    let (study, result) = (page.study, page.result);
    let target = &study.target;
    let run_sd = result.residual.run_sd.get(&target.observable).copied();
    let at_bench = result.smoothness.iter().find(|p| p.value == 0.0);
    let ours = at_bench.map_or_else(
        || DASH.to_owned(),
        |p| {
            let r = &p.result;
            format!(
                "{} ({}; {}° from the measured angle)",
                degrees(r.mean, r.sd, r.n),
                p.regime,
                signed(r.mean - target.value, 2)
            )
        },
    );
    let fitted = result
        .residual
        .simulated_before
        .first()
        .and_then(|row| row.first())
        .copied();
    page.report.paragraph(&format!(
        "All parameters at the bench means: {ours}. Measured: {}. The study reports {}° there, with \
         a sliding bed. Sd of one run: {}° ({} degrees of freedom). After the fit with priors our \
         runs give {}° (mean of {}).",
        degrees(target.value, Some(target.sd), target.n),
        fixed(study.published.sliding_angle_at_measured_deg, 2),
        digits_or_dash(run_sd),
        result.residual.noise_dof,
        fixed_or_dash(fitted, 2),
        counted(result.residual.plan.replicates, "run", "runs"),
    ));
}

/// Angle against the smoothness of the filling.
fn smoothness(page: &mut Page<'_>) -> Result<(), Error> {
    page.report
        .subsection("Angle at the bench means against the smoothness of the filling");
    page.chart(
        "smoothness",
        "Angle with all contact parameters at their bench means, for smoother and smoother bodies; \
         the level is the measured angle. Bars are the sd of runs where there is more than one.",
    );
    let caption = "Smoothness 0 is the filling as it is; the effect has no unit.";
    page.report.table(&sweep_table(
        caption,
        "smoothness",
        &page.result.smoothness,
        None,
    )?);
    Ok(())
}
