//! Measurements beside what the simulator shows, and whether they hold.

use crate::confirmation::mean;
use crate::intervals::quantile_of;
use crate::samples::{Asked, Sample, Samples, of_regime, usual_regime};
use crate::surface::Surface;
use crate::{CalibrationProblem, Comparison, MeasuredMean, Measurement, Role, SimulatedMean};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// Chance that one of the measurements of a role fails although all agree.
const ALPHA: f64 = 0.05;

/// Standard errors by which the information of slopes must exceed 0.
const NOISE: f64 = 2.0;

/// Known data of the models: surfaces about the estimate, pooled scatter.
pub(crate) type SurfacesByModel = BTreeMap<usize, Surface>;

/// Compares the measurements of a role with runs at a point.
///
/// # Formula
///
/// `z = (measured - simulated) / sqrt(sd²/n + s²/runs + g' C g)`: the measured mean, the simulated mean (s² the variance of
/// a run, pooled over all runs of the model; runs of another regime than most ended up in are counted and not averaged),
/// and for measurements that the estimate did not use the uncertainty of the
/// parameters (g the slopes, C their covariance). It holds within Student's quantile for Satterthwaite's degrees of
/// freedom at 5 % over the measurements of the role (Bonferroni). Runs with coarse grains are carried to the real size by the
/// trend of the surface, whose variance joins that of the mean.
pub(crate) fn compare(
    asked: Asked<'_>,
    role: Role,
    runs: &BTreeMap<usize, Samples>,
    surfaces: &SurfacesByModel,
    covariance: Option<&DMatrix<f64>>,
    at: &[f64],
) -> Vec<Comparison> {
    let problem = asked.problem;
    let of_role: Vec<&Measurement> = problem
        .measurements
        .iter()
        .filter(|m| m.role == role)
        .collect();
    let tails = tails_of(problem, role);
    let rows = of_role.iter().filter_map(|m| {
        let samples = runs.get(&m.model)?;
        if samples.done.is_empty() {
            return None;
        }
        let surface = surfaces.get(&m.model);
        if problem.coarsest_of(m.model) > 1.0 && !surface.is_some_and(Surface::has_trend) {
            return None;
        }
        let parameter_variance = covariance
            .zip(surface)
            .and_then(|(c, s)| parameter_variance(s, &m.observable, at, c));
        Some(Comparison {
            reach: surface.and_then(|s| reach(problem, s, &m.observable, at)),
            ..comparison(asked, m, samples, (surface, at), parameter_variance, tails)
        })
    });
    rows.collect()
}

/// Chance that a measurement of a role fails although it agrees.
pub(crate) fn tails_of(problem: &CalibrationProblem, role: Role) -> f64 {
    ALPHA / problem.measurements_of(role).len().max(1) as f64
}

/// What the simulator shows of a measurement.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Simulated {
    /// The mean over the runs.
    pub(crate) mean: SimulatedMean,
    /// Degrees of freedom of its standard error.
    pub(crate) dof: f64,
    /// Variance of the prediction from the uncertainty of the parameters.
    pub(crate) parameter_variance: Option<f64>,
}

/// A measurement beside what the simulator shows, see [`compare`].
pub(crate) fn compared(
    problem: &CalibrationProblem,
    m: &Measurement,
    simulated: Simulated,
    tails: f64,
) -> Comparison {
    let model = &problem.models[m.model];
    let Simulated {
        mean,
        dof,
        parameter_variance,
    } = simulated;
    let parts = [
        (m.variance_at(mean.mean), m.degrees_of_freedom()),
        (mean.se.powi(2), dof),
        (parameter_variance.unwrap_or(0.0), f64::INFINITY),
    ];
    let total: f64 = parts.iter().map(|p| p.0).sum();
    let squares: f64 = parts.iter().map(|(v, dof)| v * v / dof).sum();
    let z = (m.mean - mean.mean) / total.sqrt();
    let z_limit = quantile_of(tails, total * total / squares.max(f64::MIN_POSITIVE));
    Comparison {
        scene: model.scene.clone(),
        condition: model.condition.clone(),
        observable: m.observable.clone(),
        role: m.role,
        measured: MeasuredMean {
            mean: m.mean,
            sd: m.sd,
            n: m.n,
        },
        simulated: mean,
        parameter_se: parameter_variance.map(f64::sqrt),
        reach: None,
        z,
        z_limit,
        holds: z.abs() <= z_limit,
        regimes: BTreeMap::new(),
        keys: Vec::new(),
    }
}

/// g' C g of one observable.
fn parameter_variance(
    surface: &Surface,
    observable: &str,
    at: &[f64],
    covariance: &DMatrix<f64>,
) -> Option<f64> {
    let k = surface.place(observable)?;
    let mut slopes = DVector::zeros(at.len());
    for (&j, slope) in surface.parameters.iter().zip(surface.slopes(k, at)) {
        slopes[j] = slope;
    }
    let variance = (covariance * &slopes).dot(&slopes);
    variance.is_finite().then_some(variance)
}

/// How far an observable moves from a point, at least, if the tuned parameters go to the farther ends of their ranges.
///
/// # Formula
///
/// `|g|'w - 2 sqrt(s'C s)`, or 0 if that is less: g the slopes, w the ways, s the ways with the signs of the slopes, C the covariance
/// of the slopes. What noise makes of slopes that are none moves nothing.
fn reach(
    problem: &CalibrationProblem,
    surface: &Surface,
    observable: &str,
    at: &[f64],
) -> Option<f64> {
    let k = surface.place(observable)?;
    let slopes = surface.slopes(k, at);
    let mut ways = DVector::zeros(slopes.len());
    for (place, &j) in surface.tuned().iter().enumerate() {
        let [low, high] = problem.parameters[j].range;
        let way = (high - at[j]).abs().max((at[j] - low).abs());
        ways[place] = way * slopes[place].signum();
    }
    let covariance = surface.slope_covariance(at) * surface.covariance[(k, k)];
    let noise = (&covariance * &ways).dot(&ways).max(0.0).sqrt();
    let moves = DVector::from_vec(slopes).dot(&ways);
    Some((moves - NOISE * noise).max(0.0))
}

fn comparison(
    asked: Asked<'_>,
    m: &Measurement,
    samples: &Samples,
    (surface, at): (Option<&Surface>, &[f64]),
    parameter_variance: Option<f64>,
    tails: f64,
) -> Comparison {
    // Of runs that ended up differently there is no mean: those of the usual regime speak, all are counted.
    let (group, _) = of_regime(&samples.done, &usual_regime(&samples.done));
    let n = group.len();
    let (variance, dof) = scatter(&group, &m.observable, surface);
    let with_trend = surface.filter(|s| s.has_trend());
    let carried = with_trend.and_then(|s| Some(s.carried(s.place(&m.observable)?, &group, at)));
    let of_runs = || (mean(&group, &m.observable), 1.0 / n as f64);
    let (simulated, share) = carried.unwrap_or_else(of_runs);
    let simulated = Simulated {
        mean: SimulatedMean {
            mean: simulated,
            se: (share * variance).sqrt(),
            n_runs: n,
        },
        dof,
        parameter_variance,
    };
    let mut regimes = BTreeMap::new();
    for sample in samples.done.iter().filter(|s| !s.regime.is_empty()) {
        *regimes.entry(sample.regime.clone()).or_insert(0) += 1;
    }
    Comparison {
        regimes,
        keys: group.iter().map(|s| s.key.clone()).collect(),
        ..compared(asked.problem, m, simulated, tails)
    }
}

/// Variance of a run and its degrees of freedom: pooled with that about the surfaces of the model if there are any, in which the
/// scatter of these runs may be already.
fn scatter(group: &[&Sample], observable: &str, surface: Option<&Surface>) -> (f64, f64) {
    let own = group.len().saturating_sub(1) as f64;
    let of_surface = surface.and_then(|s| {
        let k = s.place(observable)?;
        Some((s.covariance[(k, k)], s.degrees_of_freedom))
    });
    let known = surface.is_some_and(|s| s.knows_scatter_of(group));
    if let Some(pooled) = of_surface.filter(|_| known) {
        return pooled;
    }
    let m = mean(group, observable);
    let squares: f64 = group
        .iter()
        .map(|s| (s.values[observable] - m).powi(2))
        .sum();
    match of_surface {
        Some((variance, dof)) => ((squares + variance * dof) / (own + dof), own + dof),
        None if own > 0.0 => (squares / own, own),
        None => (0.0, f64::INFINITY),
    }
}
