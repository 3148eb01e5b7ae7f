//! Fitted surfaces as a page takes them whose sliders move the predictions.

use crate::ReportInput;
use crate::measurement_rows::{place, role_name};
use crate::numbers::{decimals_of, observable, shown_unit};
use crate::pictures::surface_charts::measured;
use inference::Measurement;
use report::{
    ExploredPrediction, ExploredSurface, ExploredTarget, Explorer, NamedPlace, SliderParameter,
};
use response_surface::{Fit, Prediction};

/// A surface for the sliders: what it is of, the sliders of its factors, and the place where they begin.
#[derive(Debug, Clone)]
pub struct SurfaceWithSliders<'a> {
    /// Name of the predicted quantity.
    pub name: String,
    /// Its unit; empty for a plain number.
    pub unit: &'a str,
    /// The polynomial.
    pub fit: &'a Fit,
    /// Number of the slider of each factor, from 0.
    pub sliders: Vec<usize>,
    /// Natural values of the factors where the sliders begin.
    pub begin: Vec<f64>,
    /// The measured value with its standard error; `None` if it was not measured.
    pub measured: Option<ExploredTarget>,
}

/// A fit with the numbers that its predictions need; `None` if it does not predict at that place.
///
/// The predictions are those of [`Fit::predict`]: the error is that of the residuals.
pub fn explored_surface(slid: SurfaceWithSliders<'_>) -> Option<ExploredSurface> {
    let fit = slid.fit;
    let shown = fit.predict(&slid.begin).ok()?;
    let of_factors = |of: fn(&experiment_design::Factor) -> f64| fit.factors.iter().map(of);
    Some(ExploredSurface {
        unit: slid.unit.to_owned(),
        decimals: decimals(&shown),
        parameters: slid.sliders,
        middle: of_factors(experiment_design::Factor::mid).collect(),
        half: of_factors(experiment_design::Factor::half_range).collect(),
        powers: fit
            .formula
            .terms()
            .iter()
            .map(|t| t.powers().to_vec())
            .collect(),
        coefficients: fit.coefficients(),
        covariance_over_variance: fit.inverse_of_terms(),
        error_variance: fit.mse,
        t_limit: fit.t_crit_975,
        axis: axis(fit, &shown, slid.measured),
        measured: slid.measured,
        prediction: ExploredPrediction {
            mean: shown.mean,
            se_mean: shown.se_mean,
            mean95: shown.ci95,
            new95: shown.pi95,
        },
        name: slid.name,
    })
}

/// Decimals that show two digits of the error of a prediction; those of about four digits of its mean without one.
fn decimals(shown: &Prediction) -> usize {
    let of_error = shown.se_mean.and_then(decimals_of);
    of_error.unwrap_or_else(|| decimals_of(0.01 * shown.mean.abs()).unwrap_or(3))
}

/// Ends of the axis of a picture: everything that the surface says over its ranges, with its prediction interval and what
/// was measured, and a twentieth beyond.
fn axis(fit: &Fit, shown: &Prediction, measured: Option<ExploredTarget>) -> [f64; 2] {
    let half = shown.pi95.map_or(0.0, |[low, high]| 0.5 * (high - low));
    let mut values = vec![shown.mean];
    match &fit.box_extremes {
        Some(ends) => values.extend([ends.min.value, ends.max.value]),
        None => values.extend(fit.cases.iter().map(|case| case.fitted)),
    }
    let mut values: Vec<f64> = values.iter().flat_map(|v| [v - half, v + half]).collect();
    values.extend(
        measured
            .iter()
            .flat_map(|m| [m.mean - 2.0 * m.se, m.mean + 2.0 * m.se]),
    );
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // A surface without any change still has an axis.
    let room = (0.05 * (high - low)).max(1e-6 * low.abs()).max(1e-12);
    [low - room, high + room]
}

/// All surfaces of a calibration over its parameters; `None` if no surface could be analysed.
pub(crate) fn of_calibration(input: &ReportInput<'_>) -> Option<Explorer> {
    let found = input.calibration;
    let fits = || {
        found
            .surfaces
            .iter()
            .flat_map(|s| s.fits.values().flatten())
    };
    let ranges = |symbol: &str| {
        let factors = fits().flat_map(|fit| &fit.factors);
        let own: Vec<_> = factors.filter(|f| f.symbol() == symbol).collect();
        let low = own.iter().map(|f| f.low()).reduce(f64::min)?;
        Some([low, own.iter().map(|f| f.high()).reduce(f64::max)?])
    };
    // Numbers of the parameters that some surface depends on, and the ends of their sliders.
    let moved: Vec<(usize, [f64; 2])> = found
        .parameters
        .iter()
        .enumerate()
        .filter_map(|(j, p)| {
            let [low, high] = ranges(&p.symbol)?;
            Some((j, [low.min(p.value), high.max(p.value)]))
        })
        .collect();
    let parameters = moved.iter().map(|&(j, [low, high])| {
        let p = &found.parameters[j];
        SliderParameter {
            symbol: p.symbol.clone(),
            name: p.name.clone(),
            unit: shown_unit(&p.unit).to_owned(),
            low,
            high,
        }
    });
    let explorer = Explorer {
        parameters: parameters.collect(),
        places: places(input, &moved),
        surfaces: surfaces(input, &moved),
    };
    (!explorer.surfaces.is_empty()).then_some(explorer)
}

/// The estimate, the start, and the other separate solutions, where the sliders reach them.
fn places(input: &ReportInput<'_>, moved: &[(usize, [f64; 2])]) -> Vec<NamedPlace> {
    let found = input.calibration;
    let of = |value: &dyn Fn(usize) -> Option<f64>| -> Option<Vec<f64>> {
        moved.iter().map(|(j, _)| value(*j)).collect()
    };
    let mut all = vec![
        (
            "estimate".to_owned(),
            of(&|j| Some(found.parameters[j].value)),
        ),
        ("start".to_owned(), of(&|j| Some(found.parameters[j].start))),
    ];
    let others = found.solutions.separate.iter().enumerate().skip(1);
    all.extend(others.map(|(k, at)| (format!("solution {}", k + 1), of(&|j| at.get(j).copied()))));
    let reached = |values: &[f64]| {
        let ends = moved.iter().zip(values);
        ends.clone()
            .all(|((_, [low, high]), x)| (low..=high).contains(&x))
    };
    all.into_iter()
        .filter_map(|(name, values)| Some((name, values?)))
        .filter(|(_, values)| reached(values))
        .map(|(name, values)| NamedPlace { name, values })
        .collect()
}

/// The surfaces in the order of the page.
fn surfaces(input: &ReportInput<'_>, moved: &[(usize, [f64; 2])]) -> Vec<ExploredSurface> {
    let found = input.calibration;
    let slider = |symbol: &str| {
        moved
            .iter()
            .position(|(j, _)| found.parameters[*j].symbol == symbol)
    };
    let analysed = found.surfaces.iter().flat_map(|surfaces| {
        let fits = surfaces.fits.iter();
        fits.filter_map(move |(quantity, fit)| Some((surfaces, quantity, fit.as_ref()?)))
    });
    let explored = analysed.filter_map(|(surfaces, quantity, fit)| {
        let factors = fit.factors.iter();
        let sliders: Vec<usize> = factors.map(|f| slider(f.symbol())).collect::<Option<_>>()?;
        let value = |slider: &usize| found.parameters[moved[*slider].0].value;
        let target = measured(input, &surfaces.model, quantity);
        explored_surface(SurfaceWithSliders {
            name: name(input, &surfaces.model, quantity, target),
            unit: observable(quantity).1,
            fit,
            begin: sliders.iter().map(value).collect(),
            sliders,
            measured: target.map(|m| ExploredTarget {
                mean: m.mean,
                se: m.variance().sqrt(),
            }),
        })
    });
    explored.collect()
}

/// Where an observable is predicted, and what its measurement serves for.
fn name(
    input: &ReportInput<'_>,
    model: &str,
    quantity: &str,
    target: Option<&Measurement>,
) -> String {
    let known = input.problem.models.iter().find(|m| m.name == model);
    let at = known.map_or_else(|| model.to_owned(), |m| place(&m.scene, &m.condition));
    let role = target.map_or_else(String::new, |m| format!(" ({})", role_name(m.role)));
    format!("{at}: {}{role}", observable(quantity).0)
}
