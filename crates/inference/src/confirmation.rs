//! Fresh runs at the estimate: do they confirm the surfaces, or correct them?

use crate::comparison::compare as compared;
use crate::intervals::{best_of, quantile_of};
use crate::samples::{Runner, Sample, Samples, first_seed, of_regime, usual_regime, wanted};
use crate::search::{Found, Search};
use crate::surface::Surface;
use crate::{
    CalibrationProblem, Comparison, ConfirmationRound, ConfirmationRow, Error, Role, SimulatedMean,
};
use std::collections::BTreeMap;

/// Chance that surfaces which are right are contradicted in a round.
const ALPHA: f64 = 0.01;
/// Chance that a surface which is right misses a measurement.
const ALPHA_OF_A_MEASUREMENT: f64 = 0.05;
/// Share of the standard error of a measurement up to which a difference does not matter: it moves the estimate by so
/// little of its own error.
const IMMATERIAL: f64 = 0.1;
/// Rise of the misfit from the estimate to where the runs were made, up to which they count as runs at the estimate: half a
/// standard error.
const SETTLED: f64 = 0.25;
/// First stage number of the rounds.
const STAGE: u64 = 50;

/// The estimate with the fresh runs behind it.
#[derive(Debug)]
pub(crate) struct Confirmed {
    /// Surfaces, corrected where runs contradicted them, and the estimate.
    pub(crate) found: Found,
    /// Fresh runs at the estimate, by model.
    pub(crate) runs: BTreeMap<usize, Samples>,
    pub(crate) rounds: Vec<ConfirmationRound>,
    /// Whether the last round agrees with its surfaces.
    pub(crate) agrees: bool,
    /// Remarks for the reader.
    pub(crate) remarks: Vec<String>,
}

/// A row of a round.
struct Judged {
    row: ConfirmationRow,
    /// Whether a measurement is met by its surface and missed by its runs.
    decides: bool,
}

/// Runs the models of the fit at the estimate, and makes it again with surfaces that meet these runs: what a polynomial misses of
/// a response biases the estimate as long as noise hides it. If runs and surfaces disagree, or the estimate moves, fresh runs follow
/// at the new one, a few rounds at most. If the runs show that a surface misses them by more than they scatter, the search continues
/// in a smaller box.
///
/// # Errors
///
/// A campaign that was stopped, a covariance that is not positive definite.
pub(crate) fn confirm(
    runner: &Runner<'_>,
    search: &mut Search<'_>,
    mut found: Found,
    announce: &dyn Fn(&str),
) -> Result<Confirmed, Error> {
    let mut rounds = Vec::new();
    let mut remarks = Vec::new();
    let most = runner.settings.most_confirmations.max(1);
    // Surfaces of the box as its design shows them, and the fresh runs in it, one group a round.
    let mut of_design = found.surfaces.clone();
    let mut fresh: BTreeMap<usize, Vec<Vec<Sample>>> = BTreeMap::new();
    loop {
        let last = rounds.len() + 1 >= most;
        let runs = fresh_runs(runner, &found, rounds.len())?;
        let rows = compare(runner, search, &found, &runs, &mut remarks);
        let limit = normal_limit(ALPHA / rows.len().max(1) as f64);
        let agrees = rows
            .iter()
            .all(|Judged { row, decides }| !row.matters || (!decides && row.z.abs() <= limit));
        let at = found.best.clone();
        let mut is_nearer = false;
        if !last {
            (found, is_nearer) = search.nearer(found, &runs, announce)?;
        }
        rounds.push(ConfirmationRound {
            at: at.clone(),
            rows: rows.into_iter().map(|judged| judged.row).collect(),
            confirmed: agrees && !is_nearer,
        });
        if is_nearer {
            of_design.clone_from(&found.surfaces);
            fresh.clear();
            continue;
        }
        for (model, samples) in &runs {
            let (group, _) = of_regime(&samples.done, &usual_regime(&samples.done));
            let group = group.into_iter().cloned().collect();
            fresh.entry(*model).or_default().push(group);
        }
        let surfaces = of_design.iter().map(|surface| met_by(surface, &fresh));
        found = search.solve(found.region.clone(), surfaces.collect())?;
        // The new surfaces may meet a measurement that these runs miss: further ones decide which is right.
        let again = compare(runner, search, &found, &runs, &mut Vec::new());
        let agrees = agrees && !again.iter().any(|judged| judged.decides);
        let is_settled = is_settled(runner, &found, &at)?;
        if last || (agrees && is_settled) {
            if agrees && !is_settled {
                remarks.push(format!(
                    "after {most} rounds the estimate still moves by more than half of its standard error from where its last runs were \
                     made: raise confirmation_runs"
                ));
            }
            if !agrees {
                remarks.push(format!(
                    "after {most} rounds the fresh runs still differ from what the surfaces predict by more than their error"
                ));
            }
            return Ok(Confirmed {
                found,
                runs,
                rounds,
                agrees,
                remarks,
            });
        }
    }
}

/// A surface that meets the fresh runs of its model.
fn met_by(surface: &Surface, fresh: &BTreeMap<usize, Vec<Vec<Sample>>>) -> Surface {
    let groups = fresh.get(&surface.model).map_or(&[][..], Vec::as_slice);
    let groups: Vec<Vec<&Sample>> = groups.iter().map(|g| g.iter().collect()).collect();
    surface.with_scatter(&groups).anchored(&groups.concat())
}

/// Whether the estimate lies so near to where the runs were made that these count as runs at the estimate.
fn is_settled(runner: &Runner<'_>, found: &Found, at: &[f64]) -> Result<bool, Error> {
    let fit = found.fit(runner.problem);
    let coded: Vec<f64> = (0..at.len())
        .map(|j| found.region.coded(j, at[j]).clamp(-1.0, 1.0))
        .collect();
    let rise = fit.misfit(&coded, &found.whitening) - best_of(&found.minima)?.misfit;
    Ok(rise <= SETTLED)
}

/// The models of the fit at the estimate.
fn fresh_runs(
    runner: &Runner<'_>,
    found: &Found,
    round: usize,
) -> Result<BTreeMap<usize, Samples>, Error> {
    let n = runner.settings.confirmation_runs.max(2);
    let list = found.surfaces.iter().flat_map(|surface| {
        let seed = first_seed(runner.settings, STAGE + round as u64, surface.model);
        // Of the finest grains, from which the trend carries least.
        let finest = runner.problem.finest_of(surface.model);
        wanted(seed, (surface.model, finest), &vec![found.best.clone(); n])
    });
    let list: Vec<_> = list.collect();
    runner.run(&list)
}

/// Rows of a round.
fn compare(
    runner: &Runner<'_>,
    search: &Search<'_>,
    found: &Found,
    runs: &BTreeMap<usize, Samples>,
    remarks: &mut Vec<String>,
) -> Vec<Judged> {
    let problem = runner.problem;
    let mut rows = Vec::new();
    let by_model = found.surfaces.iter().map(|s| (s.model, s.clone()));
    let met = compared(
        runner.asked,
        Role::Fit,
        runs,
        &by_model.collect(),
        None,
        &found.best,
    );
    for surface in &found.surfaces {
        let none = Samples::default();
        let samples = runs.get(&surface.model).unwrap_or(&none);
        remarks_on(runner, search, surface, samples, remarks);
        if !samples.done.is_empty() {
            rows.extend(judged(problem, found, surface, samples, &met));
        }
    }
    rows
}

/// Reports a model without a run at the estimate, and one whose runs have another regime than its surface.
fn remarks_on(
    runner: &Runner<'_>,
    search: &Search<'_>,
    surface: &Surface,
    samples: &Samples,
    remarks: &mut Vec<String>,
) {
    let name = &runner.problem.models[surface.model].name;
    let n = samples.done.len();
    if n == 0 {
        let reason = samples.failed.first().map_or("", |f| &f.1);
        let remark = format!(
            "no run of {name} gives a result at the estimate, so that nothing confirms its surface: {reason}"
        );
        if !remarks.contains(&remark) {
            remarks.push(remark);
        }
        return;
    }
    let regime = search.regime(surface.model);
    let others = samples.done.iter().filter(|s| s.regime != regime).count();
    if 2 * others > n {
        remarks.push(format!(
            "at the estimate {others} of {n} runs of {name} ended up otherwise than {regime}, which its surface \
             describes: what was measured lies at or beyond a change of regime"
        ));
    }
}

/// Fresh runs of one model against its surface, one row for each measurement of the fit; `met` says which of these the runs meet.
fn judged(
    problem: &CalibrationProblem,
    found: &Found,
    surface: &Surface,
    samples: &Samples,
    met: &[Comparison],
) -> Vec<Judged> {
    let model = &problem.models[surface.model];
    let (group, _) = of_regime(&samples.done, &usual_regime(&samples.done));
    let pooled = surface.with_scatter(std::slice::from_ref(&group));
    let of_observable = |(k, observable): (usize, &String)| {
        let measured = problem.measurements.iter().find(|m| {
            m.model == surface.model && m.observable == *observable && m.role == Role::Fit
        })?;
        let at = (&found.best[..], group[0].factor);
        let runs = (mean(&group, observable), group.len());
        let mut row = row(&model.name, &pooled, (k, observable), at, runs);
        let difference = (row.simulated.mean - row.predicted).abs();
        let of_measured = measured.variance_at(row.predicted);
        row.matters = difference > IMMATERIAL * of_measured.sqrt();
        let is_missed = met.iter().any(|m| {
            !m.holds
                && m.observable == *observable
                && m.scene == model.scene
                && m.condition == model.condition
        });
        let of_surface = pooled.leverage(&found.best) * pooled.covariance[(k, k)];
        let error = (of_measured + of_surface).sqrt();
        let off = (measured.mean - pooled.value(k, &found.best)).abs();
        let decides = is_missed && off <= error * normal_limit(ALPHA_OF_A_MEASUREMENT);
        Some(Judged { row, decides })
    };
    let observables = surface.observables.iter().enumerate();
    observables.filter_map(of_observable).collect()
}

/// One observable at the estimate: what the surface says of grains as large as those of the runs, what the runs show.
///
/// z is turned into a normal one with the same tail, so that one limit serves rows of different degrees of freedom.
fn row(
    model: &str,
    surface: &Surface,
    (k, observable): (usize, &str),
    (at, factor): (&[f64], f64),
    (mean, n): (f64, usize),
) -> ConfirmationRow {
    let variance = surface.covariance[(k, k)];
    let predicted = surface.value_of(k, at, factor);
    let of_surface = surface.leverage_of(at, factor) * variance;
    let of_runs = variance / n as f64;
    let se = (of_surface + of_runs).sqrt();
    let t = if se > 0.0 {
        (mean - predicted) / se
    } else {
        0.0
    };
    ConfirmationRow {
        model: model.to_owned(),
        observable: observable.to_owned(),
        predicted,
        predicted_se: of_surface.sqrt(),
        simulated: SimulatedMean {
            mean,
            se: of_runs.sqrt(),
            n_runs: n,
        },
        z: normal_score(t, surface.degrees_of_freedom),
        matters: true,
    }
}

/// |z| that is exceeded with a chance of `alpha`.
fn normal_limit(alpha: f64) -> f64 {
    quantile_of(alpha, f64::INFINITY)
}

/// The normal score with the two-sided tail of Student's t.
fn normal_score(t: f64, degrees_of_freedom: f64) -> f64 {
    use probability::{normal_quantile, t_two_sided_tail};
    let tail = t_two_sided_tail(t, degrees_of_freedom);
    let score = tail.and_then(|p| normal_quantile(1.0 - 0.5 * p));
    // Beyond the digits of 1 - p the score is that of t itself or less.
    score
        .filter(|z| z.is_finite())
        .map_or(t, |z| z * t.signum())
}

/// Mean of an observable over runs.
pub(crate) fn mean(group: &[&Sample], observable: &str) -> f64 {
    let sum: f64 = group.iter().map(|s| s.values[observable]).sum();
    sum / group.len() as f64
}
