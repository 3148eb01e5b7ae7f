//! Pareto chart and half-normal plot of the screening.

use super::NamedPicture;
use crate::Error;
use calibration::ScreeningResult;
use report::{AxisTitle, Effect, HalfNormal, Level, Pareto};

/// Both charts; the Pareto chart shows t values where the dummy columns give an error, effects
/// otherwise.
pub(super) fn charts(result: &ScreeningResult) -> Result<Vec<NamedPicture>, Error> {
    let screening = &result.screening;
    let mut charts = Vec::new();
    let pareto = match &screening.pareto {
        Some(p) => Pareto {
            size: AxisTitle::new("|t| against the dummy columns", ""),
            effects: p
                .t_abs
                .iter()
                .map(|(name, t)| {
                    let negative = p.sign.get(name).is_some_and(|s| *s < 0);
                    Effect::new(name, if negative { -t } else { *t })
                })
                .filter(|e| e.value.is_finite())
                .collect(),
            limits: [
                ("t, 5 %", p.t_limit),
                ("Bonferroni, 5 %", p.bonferroni_terms),
            ]
            .into_iter()
            .filter_map(|(name, limit)| Some(Level::new(name, limit?)))
            .collect(),
        },
        None => Pareto {
            size: AxisTitle::new("|effect|", "°"),
            effects: screening
                .factors
                .iter()
                .map(|f| Effect::new(&f.factor, f.effect))
                .collect(),
            limits: Vec::new(),
        },
    };
    charts.push(NamedPicture::chart("screening-pareto", pareto.draw()?));
    if let Some(all) = &screening.saturated {
        let chart = HalfNormal {
            size: AxisTitle::new("|effect|", "°"),
            effects: all
                .effects
                .iter()
                .map(|(name, e)| Effect::new(name, *e))
                .collect(),
            standard_error: Some(all.lenth.pse),
            named_above: all.lenth.me.unwrap_or(0.0),
        };
        charts.push(NamedPicture::chart("screening-half-normal", chart.draw()?));
    }
    Ok(charts)
}
