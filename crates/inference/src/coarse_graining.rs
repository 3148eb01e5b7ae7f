//! Runs with grains coarser than the real ones: what the trend with their size says of real ones, and whether that may be used.

use crate::search::{Found, Search};
use crate::surface::Surface;
use crate::{CalibrationProblem, CoarseGraining, Error, Measurement, Role, SizeTrend};
use input::quantity::significant;

/// Chance that a straight trend is said to be bent, shared among the measurements.
const ALPHA: f64 = 0.01;
/// By how much a bend must change the value for real grains, in standard errors of what was measured: less moves the estimate by less
/// than a quarter of its own error.
const MATTERS: f64 = 0.25;

/// The trends of what the fit uses, at the best point.
///
/// # Formula
///
/// With b the slope per real diameter and f the factor of the finest grains, a mean shifts by `-b (f - 1)` from these to real ones, with
/// the standard error `s (f - 1)`, s that of b. Two sizes F and f give `s = c / (F - f)`, so that the error stays below E for `f` of at
/// most `(1 + F q) / (1 + q)` with `q = E / c`.
///
/// # Errors
///
/// [`Error::CoarseGraining`] if a trend is not known, by more than it may be unknown, or bent.
pub(crate) fn trends(
    problem: &CalibrationProblem,
    search: &Search<'_>,
    found: &Found,
) -> Result<Vec<SizeTrend>, Error> {
    let Some(coarse) = &problem.coarse_graining else {
        return Ok(Vec::new());
    };
    let of_fit = problem.measurements.iter().filter(|m| m.role == Role::Fit);
    let rows = of_fit.clone().count() as f64;
    let (mut trends, mut wrong) = (Vec::new(), Vec::new());
    for measured in of_fit.filter(|m| coarse.models.contains(&m.model)) {
        let mut surfaces = found.surfaces.iter();
        let Some(surface) = surfaces.find(|s| s.model == measured.model) else {
            continue;
        };
        let Some(k) = surface.place(&measured.observable) else {
            continue;
        };
        let model = problem.models[measured.model].name.as_str();
        let name = format!("{} of {model}", measured.observable);
        let Some(trend) = trend_of(coarse, (measured, model), surface, k, &found.best) else {
            wrong.push(format!(
                "{name}: too few runs with another size of the grains gave a result, so that nothing shows its trend"
            ));
            continue;
        };
        wrong.extend(too_uncertain(coarse, &trend).map(|why| format!("{name}: {why}")));
        let used = search.used(surface, &found.region);
        if let Some((change, p)) = surface.bend(k, &used, &found.best)
            && p < ALPHA / rows
            && change.abs() > MATTERS * trend.measured_se
        {
            wrong.push(format!(
                "{name}: its trend with the size is bent (p = {p:.1e}); a curve through the same runs would change the value for real \
                 grains by {}, where the measurement has a standard error of {}: take finer grains",
                significant(change, 2),
                significant(trend.measured_se, 2)
            ));
        }
        trends.push(trend);
    }
    if wrong.is_empty() {
        Ok(trends)
    } else {
        Err(Error::CoarseGraining { lines: wrong })
    }
}

/// The trend of a measured observable of a model at a point; `None` if the runs have one size.
fn trend_of(
    coarse: &CoarseGraining,
    (measured, model): (&Measurement, &str),
    surface: &Surface,
    k: usize,
    at: &[f64],
) -> Option<SizeTrend> {
    let [coarsest, finest] = [coarse.factors.first(), coarse.factors.last()]
        .map(|factor| factor.copied().unwrap_or(1.0));
    let (slope, share) = surface.trend(k, at)?;
    let se = (share * surface.covariance[(k, k)]).sqrt();
    let measured_se = measured.variance_at(surface.value(k, at)).sqrt();
    let most = coarse.error * measured_se / (se * (coarsest - finest));
    Some(SizeTrend {
        model: model.to_owned(),
        observable: measured.observable.clone(),
        slope,
        slope_se: se,
        finest,
        shift: -slope * (finest - 1.0),
        shift_se: se * (finest - 1.0),
        measured_se,
        finest_allowed: if se > 0.0 {
            (1.0 + coarsest * most) / (1.0 + most)
        } else {
            coarsest
        },
    })
}

/// Why the error of a trend is too large to carry the mean to real grains; `None` if it is not.
fn too_uncertain(coarse: &CoarseGraining, trend: &SizeTrend) -> Option<String> {
    let most = coarse.error * trend.measured_se;
    (trend.shift_se > most).then(|| {
        format!(
            "from grains {} times as large to real ones it shifts by {} +- {}, and that error may be {} at most ({} standard \
             errors of the measurement): make the finest grains {} times as large as real ones or finer, or do more runs, \
             replicates in [design]",
            significant(trend.finest, 3),
            significant(trend.shift, 3),
            significant(trend.shift_se, 2),
            significant(most, 2),
            significant(coarse.error, 2),
            significant(trend.finest_allowed, 3),
        )
    })
}

/// The shifts to the real size, and that two sizes cannot show a bend.
pub(crate) fn remarks(problem: &CalibrationProblem, trends: &[SizeTrend]) -> Vec<String> {
    let coarse = problem.coarse_graining.iter();
    let unseen = coarse.filter(|coarse| coarse.factors.len() == 2).map(|_| {
        "two sizes of the grains cannot show whether their trend is straight; a third in [coarse_graining] factors shows it".to_owned()
    });
    let each = trends.iter().map(|t| {
        format!(
            "{} of {} shifts by {} +- {} from grains {} times as large to real ones; grains up to {} times as large keep that error \
             within what is allowed",
            t.observable,
            t.model,
            significant(t.shift, 3),
            significant(t.shift_se, 2),
            significant(t.finest, 3),
            significant(t.finest_allowed, 3)
        )
    });
    each.chain(unseen).collect()
}
