//! The response surface over its two strongest factors, with the solutions.

use super::NamedPicture;
use crate::{Error, StudyFile, StudyResult};
use report::{AxisTitle, Contour, Level, MarkedPoint};
use response_surface::Fit;

/// Nodes of the grid in each direction.
const NODES: usize = 121;

/// The two factors of the picture: their places in the fit, the stronger first.
pub(crate) fn strongest_two(fit: &Fit) -> Option<[usize; 2]> {
    let size = |k: usize| {
        fit.terms
            .get(fit.factors[k].symbol())
            .map_or(0.0, |row| row.coef.abs())
    };
    let mut places: Vec<usize> = (0..fit.factors.len()).collect();
    places.sort_by(|a, b| size(*b).total_cmp(&size(*a)));
    match places.as_slice() {
        [first, second, ..] => Some([*first, *second]),
        _ => None,
    }
}

/// Contours at the chosen values of the other factors; nothing for a single factor.
pub(super) fn chart(
    study: &StudyFile,
    result: &StudyResult,
) -> Result<Option<NamedPicture>, Error> {
    let fit = &result.surface.fit;
    let Some([across, up]) = strongest_two(fit) else {
        return Ok(None);
    };
    let [x_factor, y_factor] = [&fit.factors[across], &fit.factors[up]];
    let nodes = |low: f64, high: f64| -> Vec<f64> {
        (0..NODES)
            .map(|k| low + (high - low) * k as f64 / (NODES - 1) as f64)
            .collect()
    };
    let x_values = nodes(x_factor.low(), x_factor.high());
    let y_values = nodes(y_factor.low(), y_factor.high());
    let mut natural: Vec<f64> = fit
        .factors
        .iter()
        .map(|f| result.chosen.get(f.symbol()).copied().unwrap_or(f.mid()))
        .collect();
    let (mut values, mut region) = (Vec::new(), Vec::new());
    for y in &y_values {
        for x in &x_values {
            (natural[across], natural[up]) = (*x, *y);
            let coded = fit.coded(&natural);
            values.push(fit.value(&coded));
            region.extend(within_region(result, &coded));
        }
    }
    let has_region = region.len() == values.len();
    let title = |f: &experiment_design::Factor| {
        AxisTitle::new(
            format!("{}: {}", f.symbol(), f.name()),
            if f.unit() == "1" { "" } else { f.unit() },
        )
    };
    let contour = Contour {
        x: title(x_factor),
        y: title(y_factor),
        response: AxisTitle::new("repose angle", "°"),
        x_values,
        y_values,
        values,
        target: Some(Level::new(
            "solutions for the measured angle",
            result.solutions.target,
        )),
        region_name: if has_region {
            "not told from a solution (95 %)".into()
        } else {
            String::new()
        },
        region: if has_region { region } else { Vec::new() },
        points: points(study, result, across, up),
    };
    Ok(Some(NamedPicture::chart("surface", contour.draw()?)))
}

/// How far a coded point lies inside the region of points not told from a solution, `t² (s² x'Cx +
/// s_T²) - (ŷ - T)²`, squared degrees: 0 or above inside; none without an error variance.
fn within_region(result: &StudyResult, coded: &[f64]) -> Option<f64> {
    let fit = &result.surface.fit;
    let solutions = &result.solutions;
    let (error, t) = (solutions.error?, solutions.region.as_ref()?.t_limit);
    let target_variance = solutions.target_se.unwrap_or(0.0).powi(2);
    let variance = error.variance * fit.leverage(coded) + target_variance;
    Some(t * t * variance - (fit.value(coded) - solutions.target).powi(2))
}

/// Points of interest that lie inside the picture.
fn points(study: &StudyFile, result: &StudyResult, across: usize, up: usize) -> Vec<MarkedPoint> {
    let factors = &result.surface.fit.factors;
    let (x, y) = (&factors[across], &factors[up]);
    let bench = |symbol: &str| study.factor(symbol).ok().map(|f| f.measured.mean);
    let candidates = [
        (
            "chosen",
            [x, y].map(|f| result.chosen.get(f.symbol()).copied()),
        ),
        (
            "published optimum",
            [x, y].map(|f| study.published_optimum.get(f.symbol()).copied()),
        ),
        ("bench means", [x, y].map(|f| bench(f.symbol()))),
    ];
    let inside = |f: &experiment_design::Factor, value: f64| (f.low()..=f.high()).contains(&value);
    candidates
        .into_iter()
        .filter_map(|(name, [at_x, at_y])| {
            let (at_x, at_y) = (at_x?, at_y?);
            (inside(x, at_x) && inside(y, at_y)).then(|| MarkedPoint {
                name: name.into(),
                x: at_x,
                y: at_y,
            })
        })
        .collect()
}
