//! Which convention another code reads in another way, by the diagnosis that finds missing effects.
//!
//! The small cases are the observables, the conventions the rival effects. The slopes of [`inference::diagnosis`] decide whether
//! there is anything to explain and which conventions could be seen; runs of the reference integrator with each convention
//! changed, its factor fitted, decide between them. One change is tried first, then two, then three together.

use crate::Error;
use crate::case::{Case, cases};
use crate::convention::{
    CONVENTIONS, Change, Convention, NOTHING, Value, concerns, known_readings,
};
use crate::expected::{Expected, shift};
use crate::model::Model;
use crate::reference;
use crate::variant::Variant;
use contact_law::hertz_mindlin::{damping_ratio, restitution};
use inference::diagnosis::{
    CovarianceInput, Diagnosis, Largest, Options, Problem, ProblemFile, RefittedModel, Sign,
    Verdict, diagnose,
};
use input::quantity::significant;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde::Serialize;

/// Draws of the null distribution of the largest score.
const DRAWS: usize = 20_000;
/// Largest factor that is tried.
const LARGEST: f64 = 10.0;
/// Factors from which the fit starts.
const STARTS: [f64; 9] = [NOTHING, 0.1, 0.3, 0.5, 0.7, 1.4, 2.0, 3.0, 6.0];
/// Step of the logarithm of a factor for its slope.
const STEP: f64 = 0.02;
/// Largest number of conventions that differ together.
const TOGETHER: usize = 3;
/// Combinations of fewer conventions from which larger ones are built.
const KEPT: usize = 3;
/// Most steps of a fit, and most halvings of a step.
const STEPS: usize = 12;
const HALVINGS: usize = 6;
/// Chance below which even the best explanation leaves more than the bands, as in the diagnosis.
const LEAST_CHANCE: f64 = 0.025;
/// Standard deviations within which bed and heap must lie.
const WIDEST: f64 = 3.5;
/// Distance of a factor from a known one that always counts as the same.
const NEAR: f64 = 0.03;

/// One convention that differs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// Name of the convention.
    pub convention: String,
    /// Factor of the other code over this one; `None` for one of two ways.
    pub factor: Option<f64>,
    /// Its 95 % interval.
    pub interval95: Option<[f64; 2]>,
    /// What differs, by which factor, and what to put in.
    pub advice: String,
}

/// A number beside what was expected.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// What was expected.
    #[serde(flatten)]
    pub expected: Expected,
    /// What the other code gave.
    pub got: f64,
    /// Difference in bands.
    pub z: f64,
}

/// The answer of a check.
#[derive(Debug, Clone, Serialize)]
pub struct Checked {
    /// Whether all numbers agree.
    pub agrees: bool,
    /// Verdict on the conventions, by the small cases.
    pub verdict: Verdict,
    /// The conventions that differ if one is named; the rivals of a tie; the suspects of an unknown difference.
    pub differences: Vec<Difference>,
    /// Conventions that these cases cannot show with these parameters.
    pub not_shown: Vec<String>,
    /// All numbers.
    pub rows: Vec<Row>,
    /// The diagnosis itself.
    pub diagnosis: Diagnosis,
}

/// A combination of conventions with their fitted factors.
#[derive(Debug, Clone)]
struct Fitted {
    /// Indices in [`CONVENTIONS`].
    conventions: Vec<usize>,
    /// Logarithms of the factors; 0 for a switch.
    logs: Vec<f64>,
    /// Residual in bands.
    residual: DVector<f64>,
    /// Standard errors of the logarithms.
    errors: Vec<f64>,
}

impl Fitted {
    fn sum_of_squares(&self) -> f64 {
        self.residual.norm_squared()
    }
}

/// The small cases with what was measured, ready for readings of the parameters.
struct Bench<'a> {
    model: &'a Model,
    /// The reading with the conventions that are accepted.
    base: Variant,
    /// By how much these move the numbers.
    moved: Vec<f64>,
    cases: Vec<Case>,
    nominal: Vec<Vec<f64>>,
    /// Which cases each convention changes.
    affected: Vec<Vec<bool>>,
    /// Got minus expected, in bands.
    residual: DVector<f64>,
    bands: DVector<f64>,
    names: Vec<String>,
}

/// Compares the numbers of another code, in the order of the expected rows, with these; `accepted` are conventions that belong to the
/// other code, by name.
///
/// # Errors
///
/// Expected rows that do not belong to the model, a convention that is unknown or no matter of one of two ways, a diagnosis that
/// cannot be computed.
pub fn check(
    model: &Model,
    expected: &[Expected],
    got: &[f64],
    accepted: &[String],
) -> Result<Checked, Error> {
    let bench = Bench::new(model, expected, got, accepted)?;
    let first = bench.diagnose()?;
    let (diagnosis, best) = if first.verdict == Verdict::None {
        (first, Vec::new())
    } else {
        bench.decide(first)
    };
    let moved = bench.moved.iter().copied().chain(std::iter::repeat(0.0));
    let rows: Vec<Row> = expected
        .iter()
        .zip(got)
        .zip(moved)
        .map(|((expected, &got), moved)| Row {
            z: (got - expected.value - moved) / expected.band,
            expected: Expected {
                value: expected.value + moved,
                ..expected.clone()
            },
            got,
        })
        .collect();
    let packed = rows.iter().filter(|row| row.expected.varies);
    let agrees = diagnosis.verdict == Verdict::None
        && packed.map(|row| row.z.abs()).fold(0.0, f64::max) < WIDEST;
    let mut differences: Vec<Difference> = Vec::new();
    for difference in best.iter().flat_map(|fitted| bench.differences(fitted)) {
        if !differences
            .iter()
            .any(|known| known.convention == difference.convention)
        {
            differences.push(difference);
        }
    }
    let mut not_shown = diagnosis.not_testable.clone();
    let absent = CONVENTIONS
        .iter()
        .filter(|convention| !concerns(convention, model));
    not_shown.extend(absent.map(|convention| convention.name.to_owned()));
    Ok(Checked {
        agrees,
        verdict: diagnosis.verdict,
        differences,
        not_shown,
        rows,
        diagnosis,
    })
}

impl<'a> Bench<'a> {
    fn new(
        model: &'a Model,
        expected: &[Expected],
        got: &[f64],
        accepted: &[String],
    ) -> Result<Self, Error> {
        let cases = cases(model);
        let names: Vec<String> = cases
            .iter()
            .flat_map(|case| {
                case.quantities
                    .iter()
                    .map(|q| format!("{} {}", case.name, q.name()))
            })
            .collect();
        let small: Vec<(&Expected, f64)> = expected
            .iter()
            .zip(got.iter().copied())
            .filter(|(row, _)| !row.varies)
            .collect();
        let stored: Vec<String> = small
            .iter()
            .map(|(row, _)| format!("{} {}", row.case, row.quantity))
            .collect();
        if stored != names || expected.len() != got.len() {
            return Err(Error::OtherVersion);
        }
        let base = with_accepted(model, accepted)?;
        let nominal: Vec<Vec<f64>> = cases
            .iter()
            .map(|case| reference::run(case, &base))
            .collect();
        let own = Variant::nominal(model);
        let moved = cases
            .iter()
            .zip(&nominal)
            .flat_map(|(case, nominal)| shift(case, nominal, &own));
        let moved: Vec<f64> = moved.map(|by| -by).collect();
        let affected = CONVENTIONS
            .iter()
            .map(|convention| affected(convention, &base, &cases, &nominal));
        let bands = DVector::from_iterator(small.len(), small.iter().map(|(row, _)| row.band));
        let residual = small
            .iter()
            .zip(&moved)
            .map(|((row, got), moved)| (got - row.value - moved) / row.band);
        let residual: Vec<f64> = residual.collect();
        Ok(Self {
            residual: DVector::from_vec(residual),
            affected: affected.collect(),
            base,
            moved,
            model,
            cases,
            nominal,
            bands,
            names,
        })
    }

    /// Change of the numbers, in bands, by conventions read in other ways.
    fn shift(&self, conventions: &[usize], logs: &[f64]) -> DVector<f64> {
        let mut variant = self.base.clone();
        for (convention, log) in conventions.iter().zip(logs) {
            CONVENTIONS[*convention].apply(&mut variant, log.exp());
        }
        let each = (0..self.cases.len()).flat_map(|c| {
            let nominal = &self.nominal[c];
            if conventions.iter().any(|&k| self.affected[k][c]) {
                shift(&self.cases[c], nominal, &variant)
            } else {
                vec![0.0; nominal.len()]
            }
        });
        DVector::from_iterator(self.bands.len(), each).component_div(&self.bands)
    }

    /// Conventions that can matter to the model.
    fn concerned(&self) -> Vec<usize> {
        (0..CONVENTIONS.len())
            .filter(|&k| concerns(&CONVENTIONS[k], self.model))
            .collect()
    }

    /// The diagnosis by the slopes: the logarithm of a factor is its amplitude, and 1 the other way of a switch.
    fn diagnose(&self) -> Result<Diagnosis, Error> {
        let n = self.names.len();
        let library = self.concerned();
        let columns: Vec<DVector<f64>> = library
            .iter()
            .map(|&k| {
                if CONVENTIONS[k].is_factor() {
                    self.shift(&[k], &[STEP]) / STEP
                } else {
                    self.shift(&[k], &[0.0])
                }
            })
            .collect();
        let name = |k: &usize| CONVENTIONS[*k].name.to_owned();
        let range = |k: &usize| {
            if CONVENTIONS[*k].is_factor() {
                (Largest::Ends([NOTHING.ln(), LARGEST.ln()]), Sign::Any)
            } else {
                (Largest::Ends([0.0, 1.0]), Sign::Positive)
            }
        };
        let unit = |scale: f64| {
            let row = |i| (0..n).map(|j| if i == j { scale } else { 0.0 }).collect();
            CovarianceInput::Matrix((0..n).map(row).collect())
        };
        let file = ProblemFile {
            id: "passport".into(),
            conditions: vec![inference::diagnosis::Condition::default()],
            observables: self.names.clone(),
            residual_obs_minus_sim: self.residual.iter().map(|r| Some(*r)).collect(),
            cov_measurement: Some(unit(1.0)),
            cov_simulator: Some(unit(0.0)),
            sensitivities_declared: vec![Vec::new(); n],
            library: library.iter().map(name).collect(),
            sensitivities_library: (0..n)
                .map(|row| columns.iter().map(|c| c[row]).collect())
                .collect(),
            largest_amplitudes: library.iter().map(|k| (name(k), range(k).0)).collect(),
            signs: library.iter().map(|k| (name(k), range(k).1)).collect(),
            ..ProblemFile::default()
        };
        let options = Options {
            draws: DRAWS,
            ..Options::new(1)
        };
        Ok(diagnose(&Problem::try_from(file)?, &options)?)
    }

    /// Decides by runs with the conventions changed: of one, or of as few together as explain the numbers.
    fn decide(&self, first: Diagnosis) -> (Diagnosis, Vec<Fitted>) {
        let library = self.concerned();
        let none = self.at(&[], Vec::new());
        let mut kept = vec![none];
        let mut singles = Vec::new();
        for together in 1..=TOGETHER {
            let mut fits = self.larger(&kept, &library);
            fits.sort_by(|a, b| a.sum_of_squares().total_cmp(&b.sum_of_squares()));
            let models: Vec<RefittedModel> = fits.iter().map(refitted).collect();
            let decided = first.clone().decided_by_refits(&models, &[]);
            let chance = decided.refits.first().and_then(|best| best.p);
            if chance.is_some_and(|p| p > LEAST_CHANCE) {
                let standing = decided.refits.iter().zip(fits);
                let fits = standing.filter(|(refit, _)| !refit.refuted);
                let fits = fits.map(|(_, fit)| fit).collect();
                return (decided, fits);
            }
            fits.truncate(KEPT);
            if together == 1 {
                singles.clone_from(&fits);
            }
            kept = fits;
        }
        let models: Vec<RefittedModel> = singles.iter().map(refitted).collect();
        singles.truncate(1);
        (first.decided_by_refits(&models, &[]), singles)
    }

    /// Each combination with one more convention, fitted.
    fn larger(&self, fits: &[Fitted], library: &[usize]) -> Vec<Fitted> {
        let mut sets: Vec<(Vec<usize>, &[f64])> = Vec::new();
        for fit in fits {
            for &k in library.iter().filter(|k| !fit.conventions.contains(k)) {
                let mut set = fit.conventions.clone();
                set.push(k);
                let same = |other: &Vec<usize>| set.iter().all(|k| other.contains(k));
                if !sets.iter().any(|(other, _)| same(other)) {
                    sets.push((set, &fit.logs));
                }
            }
        }
        let fits = sets.par_iter();
        fits.map(|(set, before)| self.fit(set, before)).collect()
    }

    /// Fits the factors of conventions that are read in other ways together, from the factors of all but the last; that of the last
    /// starts from the best of a grid.
    fn fit(&self, conventions: &[usize], before: &[f64]) -> Fitted {
        let free: Vec<usize> = (0..conventions.len())
            .filter(|&k| CONVENTIONS[conventions[k]].is_factor())
            .collect();
        let at = |log: f64| {
            let mut logs = before.to_vec();
            logs.push(log);
            self.at(conventions, logs)
        };
        if !conventions
            .last()
            .is_some_and(|&k| CONVENTIONS[k].is_factor())
        {
            return self.improve(at(0.0), &free);
        }
        let starts: Vec<Fitted> = STARTS.iter().map(|start| at(start.ln())).collect();
        let order = |a: &Fitted, b: &Fitted| a.sum_of_squares().total_cmp(&b.sum_of_squares());
        let best = starts.into_iter().min_by(order);
        best.map_or_else(|| at(0.0), |best| self.improve(best, &free))
    }

    /// Gauss-Newton steps with halving.
    fn improve(&self, start: Fitted, free: &[usize]) -> Fitted {
        let mut fitted = start;
        if free.is_empty() {
            return fitted;
        }
        for _ in 0..STEPS {
            let slopes = self.slopes(&fitted.conventions, &fitted.logs, free);
            let step = slopes.svd(true, true).solve(&fitted.residual, 1e-9);
            let Ok(mut step) = step else { break };
            let before = fitted.sum_of_squares();
            for _ in 0..HALVINGS {
                let mut logs = fitted.logs.clone();
                for (&k, by) in free.iter().zip(step.iter()) {
                    logs[k] = (logs[k] + by.clamp(-0.5, 0.5)).clamp(NOTHING.ln(), LARGEST.ln());
                }
                let next = self.at(&fitted.conventions, logs);
                if next.sum_of_squares() < before {
                    fitted = next;
                    break;
                }
                step *= 0.5;
            }
            // Further steps do not matter: less than a thousandth of what is left, or of the square of a band.
            if before - fitted.sum_of_squares() <= 1e-3 * before.min(1.0) {
                break;
            }
        }
        let slopes = self.slopes(&fitted.conventions, &fitted.logs, free);
        let inverse = slopes.tr_mul(&slopes).try_inverse();
        for (place, &k) in free.iter().enumerate() {
            // Where the numbers no longer follow a factor, as in a contact that sticks, nothing limits it.
            let variance = inverse.as_ref().map(|inverse| inverse[(place, place)]);
            fitted.errors[k] = variance.map_or(f64::INFINITY, |v| v.max(0.0).sqrt());
        }
        fitted
    }

    /// Slopes of the numbers, in bands, by the logarithms of the free factors.
    fn slopes(&self, conventions: &[usize], logs: &[f64], free: &[usize]) -> DMatrix<f64> {
        let here = self.shift(conventions, logs);
        let columns: Vec<DVector<f64>> = free
            .iter()
            .map(|&k| {
                let mut beside = logs.to_vec();
                beside[k] += STEP;
                (self.shift(conventions, &beside) - &here) / STEP
            })
            .collect();
        DMatrix::from_columns(&columns)
    }

    fn at(&self, conventions: &[usize], logs: Vec<f64>) -> Fitted {
        Fitted {
            residual: &self.residual - self.shift(conventions, &logs),
            errors: vec![0.0; logs.len()],
            conventions: conventions.to_vec(),
            logs,
        }
    }

    fn differences(&self, fitted: &Fitted) -> Vec<Difference> {
        let each = fitted
            .conventions
            .iter()
            .zip(&fitted.logs)
            .zip(&fitted.errors);
        each.map(|((&k, &log), &error)| difference(&CONVENTIONS[k], self.model, log, error))
            .collect()
    }
}

/// The reading of this solver with the conventions that are accepted.
fn with_accepted(model: &Model, accepted: &[String]) -> Result<Variant, Error> {
    let mut base = Variant::nominal(model);
    for name in accepted {
        let found = CONVENTIONS
            .iter()
            .find(|c| c.name == name && !c.is_factor());
        let Some(convention) = found else {
            let known = CONVENTIONS
                .iter()
                .filter(|c| !c.is_factor())
                .map(|c| c.name);
            return Err(Error::Accepted {
                name: name.clone(),
                known: known.collect::<Vec<_>>().join(", "),
            });
        };
        convention.apply(&mut base, 1.0);
    }
    Ok(base)
}

/// Which cases a convention changes, a little or as far as it goes.
fn affected(
    convention: &Convention,
    base: &Variant,
    cases: &[Case],
    nominal: &[Vec<f64>],
) -> Vec<bool> {
    let factors: &[f64] = if convention.is_factor() {
        &[NOTHING, 1.0 + STEP, LARGEST]
    } else {
        &[1.0]
    };
    let changes = |case: &Case, nominal: &[f64]| {
        factors.iter().any(|factor| {
            let mut variant = base.clone();
            convention.apply(&mut variant, *factor);
            shift(case, nominal, &variant).iter().any(|by| *by != 0.0)
        })
    };
    let concerned = concerns(convention, &base.model);
    cases
        .iter()
        .zip(nominal)
        .map(|(case, nominal)| concerned && changes(case, nominal))
        .collect()
}

/// A fit as the diagnosis takes it; its runs have no noise.
fn refitted(fit: &Fitted) -> RefittedModel {
    RefittedModel {
        effects: fit
            .conventions
            .iter()
            .map(|&k| CONVENTIONS[k].name.to_owned())
            .collect(),
        residual: fit.residual.iter().copied().collect(),
        noise: 0.0,
    }
}

/// A convention that differs, with its factor in words.
fn difference(convention: &Convention, model: &Model, log: f64, error: f64) -> Difference {
    let name = convention.name.to_owned();
    let (value, at) = match convention.change {
        Change::Switch { remedy, .. } => {
            return Difference {
                convention: name,
                factor: None,
                interval95: None,
                advice: format!("{}: {remedy}", convention.subject),
            };
        }
        Change::Factor { value, at, .. } => (value, at),
    };
    let (factor, width) = (log.exp(), 1.96 * error);
    let interval = [(log - width).exp(), (log + width).exp()];
    let near = |known: f64| {
        (known.ln() - log).abs() < NEAR.max(3.0 * error).min(3.0 * NEAR)
            || (known <= NOTHING && factor < 2.0 * NOTHING)
    };
    let known = known_readings(convention, model);
    let reading = known
        .iter()
        .filter(|(known, _)| near(*known))
        .min_by(|a, b| (a.0.ln() - log).abs().total_cmp(&(b.0.ln() - log).abs()));
    let reading = reading.map_or_else(
        || "no convention with this factor is known here".to_owned(),
        |(_, words)| words.clone(),
    );
    let interval = interval.map(|end| end.clamp(NOTHING, LARGEST));
    let [low, high] = interval.map(|x| significant(x, 3));
    let shown = significant(factor, 3);
    let put_in = put_in(value, at, model, factor);
    Difference {
        advice: format!(
            "{} is {shown} times ({low} to {high}) that of the model: {reading}{put_in}",
            convention.subject
        ),
        convention: name,
        factor: Some(factor),
        interval95: Some(interval),
    }
}

/// The value that makes up for a factor.
fn put_in(value: Value, at: [bool; 2], model: &Model, factor: f64) -> String {
    let places = ["between grains", "at the wall"];
    if factor < 2.0 * NOTHING {
        return String::new();
    }
    let each = (0..2).filter(|&k| at[k]).map(|k| {
        let contact = &model.contacts[k];
        let (what, value) = match value {
            Value::Rolling => ("rolling friction", contact.rolling_friction / factor),
            Value::Friction => ("static friction", contact.static_friction / factor),
            Value::Restitution => (
                "restitution",
                restitution(damping_ratio(contact.restitution) / factor),
            ),
            Value::Cohesion | Value::Modulus | Value::Derived => return None,
        };
        Some(format!("{what} {} {}", significant(value, 3), places[k]))
    });
    let values: Vec<String> = each.flatten().collect();
    match value {
        Value::Derived => String::new(),
        Value::Cohesion => format!(
            "; multiply the attraction by {}",
            significant(1.0 / factor, 3)
        ),
        Value::Modulus => format!("; multiply the moduli by {}", significant(1.0 / factor, 3)),
        _ => format!("; put in {}", values.join(" and ")),
    }
}
