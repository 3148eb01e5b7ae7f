//! Reduction of a model, one term at a time, without breaking its hierarchy.

use experiment_design::Factor;
use serde::{Deserialize, Serialize};

use crate::{Error, Fit, Model, Observations, Weighting, fit_weighted};

/// Rule by which a term is removed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ReductionRule {
    /// The least significant term goes while its p is above this limit.
    PValue(f64),
    /// The term goes whose loss lowers Akaike's corrected criterion most, while one does.
    Aicc,
    /// The same with Schwarz's criterion.
    Bic,
}

/// A term that went.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReductionStep {
    /// Name of the term.
    pub dropped: String,
    /// Its p in the model it left.
    pub p: Option<f64>,
    /// The criterion of the smaller model; none with p values.
    pub criterion: Option<f64>,
}

/// Drops terms from a model until the rule keeps all that are left. A term stays as long as a
/// product or power of it is in the model, and so does the intercept.
///
/// The p values and intervals of the model that is left do not know of the choice: they are too
/// narrow, the more so the more terms were tried.
///
/// # Errors
/// Those of [`fit_weighted`]; [`Error::SettingOutOfRange`] for a limit of p outside 0 to 1.
pub fn reduce(
    factors: &[Factor],
    model: &Model,
    data: &Observations,
    weighting: Weighting,
    rule: ReductionRule,
) -> Result<(Fit, Vec<ReductionStep>), Error> {
    if let ReductionRule::PValue(limit) = rule
        && !(0.0..=1.0).contains(&limit)
    {
        return Err(Error::SettingOutOfRange {
            what: "the limit of p",
            value: limit,
            range: "0 to 1",
        });
    }
    let mut model = model.clone();
    let mut fit = fit_weighted(factors, &model, data, weighting)?;
    let mut steps = Vec::new();
    while let Some(step) = next_step(&fit, &model, rule) {
        let names = model.names();
        let keep: Vec<bool> = names.iter().map(|name| *name != step.dropped).collect();
        model = model.subset(&keep);
        fit = fit_weighted(factors, &model, data, weighting)?;
        steps.push(step);
    }
    Ok((fit, steps))
}

/// The term that goes next; none if all stay.
fn next_step(fit: &Fit, model: &Model, rule: ReductionRule) -> Option<ReductionStep> {
    let free = |i: &usize| {
        let term = &model.terms()[*i];
        let contained = |(j, other): (usize, &crate::Term)| j != *i && other.contains(term);
        term.degree() > 0 && !model.terms().iter().enumerate().any(contained)
    };
    let candidate = |i: usize| {
        let dropped = model.name(&model.terms()[i]);
        let row = fit.terms.get(&dropped)?;
        let criterion = match rule {
            ReductionRule::PValue(_) => None,
            rule => Some(criterion_without(fit, row.ss_partial?, rule)?),
        };
        Some(ReductionStep {
            dropped,
            p: row.p,
            criterion,
        })
    };
    let candidates = (0..model.terms().len()).filter(free).filter_map(candidate);
    match rule {
        ReductionRule::PValue(limit) => candidates
            .filter(|step| step.p.is_some_and(|p| p > limit))
            .max_by(|a, b| a.p.unwrap_or(0.0).total_cmp(&b.p.unwrap_or(0.0))),
        rule => {
            let now = criterion_without(fit, 0.0, rule)?;
            let size = |step: &ReductionStep| step.criterion.unwrap_or(f64::INFINITY);
            candidates
                .min_by(|a, b| size(a).total_cmp(&size(b)))
                .filter(|step| size(step) < now)
        }
    }
}

/// The criterion of the fit (`ss` = 0), or of the fit without a term of that partial sum of squares.
fn criterion_without(fit: &Fit, ss: f64, rule: ReductionRule) -> Option<f64> {
    let information = fit.information.as_ref()?;
    let n = fit.n as f64;
    let base = information.minus_2_log_likelihood + n * (ss / fit.sse).ln_1p();
    let m = (fit.p + usize::from(ss == 0.0)) as f64;
    if rule == ReductionRule::Bic {
        return Some(base + m * n.ln());
    }
    let left = n - m - 1.0;
    (left > 0.0).then(|| base + 2.0 * m + 2.0 * m * (m + 1.0) / left)
}
