//! Pareto charts and half-normal plots of a screening.

use report::{AxisTitle, Plot};
use response_surface::Screening;

/// Effects as t values if the dummy columns give an error, as they are otherwise; `None` without any.
pub(crate) fn pareto(screening: &Screening, unit: &str) -> Option<Plot> {
    let Some(p) = &screening.pareto else {
        let factors = screening.factors.iter();
        let effects: Vec<_> = factors.map(|f| (f.factor.clone(), f.effect)).collect();
        let drawn = report::pareto(&AxisTitle::new("|effect|", unit), &effects, &[]);
        return (!effects.is_empty()).then_some(drawn);
    };
    let signed = |(name, t): (&str, &f64)| {
        let negative = p.sign.get(name).is_some_and(|s| *s < 0);
        (name.to_owned(), if negative { -t } else { *t })
    };
    let effects: Vec<_> = p
        .t_abs
        .iter()
        .map(signed)
        .filter(|e| e.1.is_finite())
        .collect();
    let limits = [
        ("t, 5 %", p.t_limit),
        ("Bonferroni, 5 %", p.bonferroni_terms),
    ];
    let limits: Vec<_> = limits
        .into_iter()
        .filter_map(|(name, at)| Some((name, at?)))
        .collect();
    let size = AxisTitle::new("|t| against the dummy columns", "");
    let drawn = report::pareto(&size, &effects, &limits);
    (!effects.is_empty()).then_some(drawn)
}

/// All columns against Lenth's margins; `None` if they leave room for an error.
pub(crate) fn half_normal(screening: &Screening, unit: &str) -> Option<Plot> {
    let all = screening.saturated.as_ref()?;
    let effects: Vec<_> = all
        .effects
        .iter()
        .map(|(name, e)| (name.to_owned(), *e))
        .collect();
    let limits = [
        ("margin of error", all.lenth.me),
        ("simultaneous margin of error", all.lenth.sme),
    ];
    let limits: Vec<_> = limits
        .into_iter()
        .filter_map(|(name, at)| Some((name, at?)))
        .collect();
    let size = AxisTitle::new("|effect|", unit);
    Some(report::half_normal(
        &size,
        &effects,
        Some(all.lenth.pse),
        &limits,
    ))
}
