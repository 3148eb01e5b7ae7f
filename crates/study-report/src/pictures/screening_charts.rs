//! Pareto charts and half-normal plots of a screening.

use super::{NamedPicture, plain_name};
use crate::Error;
use crate::numbers::observable;
use inference::ModelScreening;
use report::{AxisTitle, FactorEffect, HalfNormal, Level, Pareto};
use response_surface::Screening;

/// Name of the Pareto chart of an observable of a screened model, by the number of the screening.
pub(crate) fn pareto_name(number: usize, quantity: &str) -> String {
    format!("screening-{}-{}-pareto", number + 1, plain_name(quantity))
}

/// Name of the half-normal plot.
pub(crate) fn half_normal_name(number: usize, quantity: &str) -> String {
    format!(
        "screening-{}-{}-half-normal",
        number + 1,
        plain_name(quantity)
    )
}

/// Both charts of each observable.
pub(super) fn charts(number: usize, model: &ModelScreening) -> Result<Vec<NamedPicture>, Error> {
    let mut charts = Vec::new();
    for (quantity, screening) in &model.screenings {
        let unit = observable(quantity).1;
        let bars = pareto(screening, unit);
        if !bars.effects.is_empty() {
            let name = pareto_name(number, quantity);
            charts.push(NamedPicture::chart(name, bars.draw()?));
        }
        if let Some(all) = &screening.saturated {
            let effects = all.effects.iter();
            let chart = HalfNormal {
                size: AxisTitle::new("|effect|", unit),
                effects: effects
                    .map(|(name, e)| FactorEffect::new(name, *e))
                    .collect(),
                standard_error: Some(all.lenth.pse),
                named_above: all.lenth.me.unwrap_or(0.0),
                limits: [
                    ("margin of error", all.lenth.me),
                    ("simultaneous margin of error", all.lenth.sme),
                ]
                .into_iter()
                .filter_map(|(name, limit)| Some(Level::new(name, limit?)))
                .collect(),
            };
            let name = half_normal_name(number, quantity);
            charts.push(NamedPicture::chart(name, chart.draw()?));
        }
    }
    Ok(charts)
}

/// t values where the dummy columns give an error, effects otherwise.
fn pareto(screening: &Screening, unit: &str) -> Pareto {
    let Some(p) = &screening.pareto else {
        let factors = screening.factors.iter();
        return Pareto {
            size: AxisTitle::new("|effect|", unit),
            effects: factors
                .map(|f| FactorEffect::new(&f.factor, f.effect))
                .collect(),
            limits: Vec::new(),
        };
    };
    let signed = |(name, t): (&str, &f64)| {
        let negative = p.sign.get(name).is_some_and(|s| *s < 0);
        FactorEffect::new(name, if negative { -t } else { *t })
    };
    let limits = [
        ("t, 5 %", p.t_limit),
        ("Bonferroni, 5 %", p.bonferroni_terms),
    ];
    let limit = |(name, limit): (&str, Option<f64>)| Some(Level::new(name, limit?));
    Pareto {
        size: AxisTitle::new("|t| against the dummy columns", ""),
        effects: p
            .t_abs
            .iter()
            .map(signed)
            .filter(|e| e.value.is_finite())
            .collect(),
        limits: limits.into_iter().filter_map(limit).collect(),
    }
}
