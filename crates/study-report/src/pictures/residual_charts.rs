//! Charts of the study of a residual.

use super::residuals::{ResidualCondition, residual_chart};
use crate::numbers::observable;
use crate::residual::{condition_name, residual_se};
use inference::diagnosis::Evidence;
use inference::{AddedEffect, ResidualStudy};
use report::{Axis, AxisTitle, Format, Mark, Plot, PlotPoint, Shape, colour};

/// Most effects in the chart of evidence, the best first.
const MOST_EFFECTS: usize = 10;

/// What each effect takes off the structured residual, by observable; `None` without candidates.
pub(crate) fn evidence(study: &ResidualStudy) -> Option<Plot> {
    let d = &study.diagnosis;
    let mut effects: Vec<_> = d.candidates.iter().collect();
    effects.sort_by(|a, b| a.1.t_after.total_cmp(&b.1.t_after));
    effects.truncate(MOST_EFFECTS);
    let all = effects
        .iter()
        .filter_map(|(name, _)| Some((*name, d.evidence.get(*name)?)));
    let all: Vec<(&String, &Vec<Evidence>)> = all.collect();
    let parts = all.first()?.1;
    let mut plot = Plot::new(
        Axis::numbers("taken off the sum of squares of the residual", ""),
        Axis::Names(all.iter().map(|(name, _)| (*name).clone()).collect()),
    );
    for (k, part) in parts.iter().enumerate() {
        let name = match &part.observable {
            Some(name) => observable(name).0,
            None => "priors of the parameters".to_owned(),
        };
        let bar = |(row, (_, evidence)): (usize, &(&String, &Vec<Evidence>))| {
            let drop = evidence[k].drop;
            // Parts of one sign follow each other from 0.
            let before = evidence[..k].iter().map(|e| e.drop);
            let from: f64 = before.filter(|other| other * drop > 0.0).sum();
            (row, [from, from + drop])
        };
        let bars: Vec<_> = all.iter().enumerate().map(bar).collect();
        plot = plot.with(Mark::bars(name, colour::series(k), &bars));
    }
    let t0 = d.structured_residual.t0;
    let most = t0.map(|t0| t0 - d.structured_residual.df as f64);
    let most = most.filter(|most| *most > 0.0);
    Some(plot.with_all(most.map(|most| Mark::upright("all but noise", most))))
}

/// Predicted against measured values of one observable by a model, with twice their standard errors.
pub(crate) fn predicted(study: &ResidualStudy, simulated: &[Vec<f64>], k: usize) -> Plot {
    let (words, unit) = observable(&study.plan.observables[k]);
    let runs = study.plan.replicates.max(1) as f64;
    let run_sd = study.run_sd.get(&study.plan.observables[k]);
    let run_sd = run_sd.copied().unwrap_or(0.0);
    let points = |used: bool| -> Vec<PlotPoint> {
        let conditions = study.plan.conditions.iter().enumerate();
        let conditions = conditions.filter(|(_, condition)| condition.used == used);
        conditions
            .filter_map(|(c, condition)| {
                let point = PlotPoint::new(study.plan.conditions[c].values[k]?, simulated[c][k]);
                Some(PlotPoint {
                    x_error: 2.0 * study.plan.standard_error(c, k),
                    y_error: 2.0 * run_sd / runs.sqrt(),
                    label: condition_name(condition),
                    ..point
                })
            })
            .collect()
    };
    let (used, kept) = (points(true), points(false));
    // The same values on both axes.
    let ends = used.iter().chain(&kept).flat_map(|p| {
        let (x, y) = (p.x, p.y);
        [x - p.x_error, x + p.x_error, y - p.y_error, y + p.y_error]
    });
    let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
        (low.min(x), high.max(x))
    });
    let room = 0.06 * (high - low);
    let [low, high] = [low - room, high + room];
    let axis = |word: &str| Axis::Numbers {
        title: AxisTitle::new(format!("{word} {words}"), unit),
        ends: (low < high).then_some([low, high]),
    };
    let kept = (!kept.is_empty()).then(|| {
        let name = "kept for the check";
        Mark::open_points(name, Shape::Square, colour::VERMILION, kept)
    });
    let mut plot = Plot::new(axis("Measured"), axis("Predicted"))
        .with(Mark::dashed(
            "predicted = measured",
            vec![[low, low], [high, high]],
        ))
        .with(Mark::points(
            "used for the fit",
            Shape::Circle,
            colour::BLUE,
            used,
        ))
        .with_all(kept);
    plot.format = Format::Square(430.0);
    plot
}

/// Residuals of one observable by condition, before and with what was added, against twice their standard error.
pub(crate) fn residuals(study: &ResidualStudy, k: usize) -> Plot {
    let left = |simulated: &[Vec<f64>]| -> Vec<Option<f64>> {
        let rows = study.plan.conditions.iter().zip(simulated);
        rows.map(|(c, s)| c.values[k].map(|y| y - s[k])).collect()
    };
    let name = |model: &AddedEffect| {
        let names: Vec<&str> = model.effects.keys().map(String::as_str).collect();
        format!("with {}", names.join(", "))
    };
    let declared = (
        "declared model, fitted".to_owned(),
        left(&study.simulated_before),
    );
    let added = study
        .models()
        .map(|model| (name(model), left(&model.simulated)));
    let models: Vec<_> = std::iter::once(declared).chain(added).collect();
    let conditions = study.plan.conditions.iter().enumerate();
    let conditions = conditions.map(|(c, condition)| ResidualCondition {
        name: condition_name(condition),
        is_used: condition.used,
        noise: 2.0 * residual_se(study, c, k),
    });
    let (words, unit) = observable(&study.plan.observables[k]);
    let conditions: Vec<ResidualCondition> = conditions.collect();
    residual_chart(
        Axis::numbers(words, unit),
        "± 2 standard errors",
        &conditions,
        &models,
    )
}

#[cfg(test)]
mod tests {
    use super::residuals;
    use crate::test_residual::{SPEEDS, twins};
    use report::{Mark, PlotPoint};

    /// Two tied effects are two models: the chart of residuals has points for each beside those of the declared
    /// model, which misses 1 degree per rpm. A mean of four runs has a standard error of 0.05 deg, and the fit adds as much: four
    /// times both together are below 0.3 deg.
    #[test]
    fn tied_models_are_in_the_chart_of_residuals() {
        let study = twins();
        assert_eq!(study.rivals.len(), 2, "{}", study.diagnosis.summary());
        let drawn = residuals(&study, 0);
        let of_model = |name: &str| -> Vec<f64> {
            let place = drawn
                .marks
                .iter()
                .position(|mark| matches!(mark, Mark::Points { name: n, .. } if n == name));
            // The points of conditions that were kept follow those that were used.
            let marks = &drawn.marks[place.unwrap()..=place.unwrap() + 1];
            let mut points: Vec<&PlotPoint> = Vec::new();
            for mark in marks {
                if let Mark::Points { points: some, .. } = mark {
                    points.extend(some);
                }
            }
            points.sort_by(|a, b| a.x.total_cmp(&b.x));
            points.iter().map(|p| p.y).collect()
        };
        let declared = of_model("declared model, fitted");
        assert_eq!(declared.len(), SPEEDS.len());
        for (c, rpm) in SPEEDS.iter().enumerate() {
            assert!((declared[c] - rpm).abs() < 0.3, "{declared:?}");
            for name in ["with bend", "with bow"] {
                assert!(of_model(name)[c].abs() < 0.3, "{name}");
            }
        }
    }
}
