//! One setting for several responses.

use experiment_design::Factor;
use serde::{Deserialize, Serialize};

use crate::fit::ErrorSource;
use crate::surface::prediction::check_point;
use crate::surface::propagation::{coded_variances, transmitted_variance};
use crate::surface::quadratic::Quadratic;
use crate::{Error, Fit, Prediction};

/// Greatest number of solutions returned.
const MOST_SOLUTIONS: usize = 10;
/// Starts of the search.
const STARTS: usize = 200;

/// Aim for one response, unit of the response.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "aim")]
pub enum Aim {
    /// As large as possible: worth nothing at `low`, everything at `high`.
    Maximise {
        /// Worth nothing.
        low: f64,
        /// Worth everything.
        high: f64,
    },
    /// As small as possible: worth everything at `low`, nothing at `high`.
    Minimise {
        /// Worth everything.
        low: f64,
        /// Worth nothing.
        high: f64,
    },
    /// At a value: worth nothing at `low` and `high`.
    Target {
        /// Worth nothing.
        low: f64,
        /// Worth everything.
        value: f64,
        /// Worth nothing.
        high: f64,
    },
    /// Anywhere in a range.
    Range {
        /// Least value allowed.
        low: f64,
        /// Greatest value allowed.
        high: f64,
    },
}

/// An aim with its weights.
///
/// ```
/// use response_surface::{Aim, Goal};
/// let goal = Goal {
///     aim: Aim::Target { low: 30.0, value: 36.0, high: 40.0 },
///     weight: 1.0,
///     importance: 3.0,
/// };
/// assert_eq!(goal.desirability(33.0), 0.5);
/// assert_eq!(goal.desirability(41.0), 0.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Goal {
    /// Aim for the response.
    pub aim: Aim,
    /// Power of the desirability: above 1 it must come close to the aim to be worth something.
    pub weight: f64,
    /// How much this response counts, 1 to 5 by custom.
    pub importance: f64,
}

/// A goal for the standard deviation that scattering factors hand on to a response.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScatterGoal {
    /// Which response, from 0.
    pub response: usize,
    /// Standard deviations of the factors, units of the factors.
    pub factor_sd: Vec<f64>,
    /// Goal for the transmitted standard deviation.
    pub goal: Goal,
}

/// A setting.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Compromise {
    /// Weighted geometric mean of the desirabilities, 0 to 1.
    pub desirability: f64,
    /// Coded point.
    pub coded: Vec<f64>,
    /// Natural point, units of the factors.
    pub natural: Vec<f64>,
    /// Desirability of each response.
    pub each: Vec<f64>,
    /// Prediction of each response.
    pub predictions: Vec<Prediction>,
    /// Standard deviation that the factors hand on, for each goal of that kind, unit of the response.
    pub transmitted_sd: Vec<f64>,
}

impl Goal {
    /// Desirability of a value, 0 to 1.
    ///
    /// # Formula
    /// `((y - low) / (high - low))^weight` between the bounds, and its mirror image
    /// `[Derringer1980]`.
    pub fn desirability(&self, y: f64) -> f64 {
        let rise =
            |from: f64, to: f64| ((y - from) / (to - from)).clamp(0.0, 1.0).powf(self.weight);
        match self.aim {
            Aim::Maximise { low, high } => rise(low, high),
            Aim::Minimise { low, high } => rise(high, low),
            Aim::Target { low, value, .. } if y <= value => rise(low, value),
            Aim::Target { value, high, .. } => rise(high, value),
            Aim::Range { low, high } => f64::from(u8::from((low..=high).contains(&y))),
        }
    }

    /// How far a value is from being worth something, as a share of the range; 0 where it is.
    fn shortfall(&self, y: f64) -> f64 {
        let (low, high) = self.bounds();
        let width = (high - low).max(f64::MIN_POSITIVE);
        ((low - y).max(y - high).max(0.0)) / width
    }

    /// Least and greatest value of the aim.
    fn bounds(&self) -> (f64, f64) {
        match self.aim {
            Aim::Maximise { low, .. } => (low, f64::INFINITY),
            Aim::Minimise { high, .. } => (f64::NEG_INFINITY, high),
            Aim::Target { low, high, .. } | Aim::Range { low, high } => (low, high),
        }
    }

    /// Refuses invalid numbers.
    fn check(&self) -> Result<(), Error> {
        let bounds = match self.aim {
            Aim::Target { low, value, high } => vec![low, value, high],
            Aim::Maximise { low, high }
            | Aim::Minimise { low, high }
            | Aim::Range { low, high } => vec![low, high],
        };
        let ascending =
            bounds.iter().all(|x| x.is_finite()) && bounds.windows(2).all(|w| w[0] < w[1]);
        if !ascending {
            return Err(Error::GoalOrder { bounds });
        }
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let numbers = [
            ("the weight of a goal", self.weight),
            ("the importance of a goal", self.importance),
        ];
        match numbers.into_iter().find(|(_, value)| !positive(*value)) {
            None => Ok(()),
            Some((what, value)) => Err(Error::SettingOutOfRange {
                what,
                value,
                range: "above 0",
            }),
        }
    }
}

/// The best settings for several responses over the common box, best first; empty if every point
/// of the box is worth nothing.
///
/// # Formula
/// `D = (prod d_i^r_i)^(1 / sum r_i)`, r the importance. The search goes from many starts by moves
/// along one or two factors within the box, so the bounds hold exactly.
///
/// # Source
/// `[Derringer1980]`.
///
/// # Errors
/// [`Error::Length`] unless there is one goal per response; [`Error::FactorMismatch`] for responses
/// over different factors or ranges; [`Error::SettingOutOfRange`] or [`Error::GoalOrder`] for an invalid goal;
/// [`Error::DegreeTooHigh`] for goals of the scatter; [`Error::NoErrorVariance`] if the error asked for is undefined.
pub fn compromises(
    fits: &[Fit],
    goals: &[Goal],
    scatter: &[ScatterGoal],
    error: Option<ErrorSource>,
) -> Result<Vec<Compromise>, Error> {
    let wanted = Wanted::new(fits, goals, scatter)?;
    let k = fits[0].factors.len();
    let cost = |x: &[f64]| wanted.cost(x);
    let mut found: Vec<(f64, Vec<f64>)> = (0..STARTS)
        .map(|i| {
            let mut x: Vec<f64> = (0..k).map(|j| start(i, j)).collect();
            (within_box(&mut x, &cost), x)
        })
        .filter(|(cost, _)| *cost < 0.0)
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut kept: Vec<Vec<f64>> = Vec::new();
    for (_, x) in found {
        let near = |other: &Vec<f64>| x.iter().zip(other).all(|(a, b)| (a - b).abs() < 0.05);
        if kept.len() < MOST_SOLUTIONS && !kept.iter().any(near) {
            kept.push(x);
        }
    }
    kept.into_iter().map(|x| wanted.at(x, error)).collect()
}

/// Desirability of a setting, in or beyond the box: a natural point, units of the factors.
///
/// # Errors
/// Those of [`compromises`]; [`Error::Length`] for a wrong number of values, [`Error::SettingOutOfRange`] for one that is not
/// finite.
pub fn compromise_at(
    fits: &[Fit],
    goals: &[Goal],
    scatter: &[ScatterGoal],
    natural: &[f64],
    error: Option<ErrorSource>,
) -> Result<Compromise, Error> {
    let wanted = Wanted::new(fits, goals, scatter)?;
    check_point(&fits[0], natural)?;
    let mut found = wanted.at(fits[0].coded(natural), error)?;
    // As given, without the rounding of coded values.
    found.natural = natural.to_vec();
    Ok(found)
}

/// Responses with their goals, checked.
struct Wanted<'a> {
    /// The responses.
    fits: &'a [Fit],
    /// Coefficients of each response.
    coefficients: Vec<Vec<f64>>,
    /// What hands scatter on.
    scatters: Vec<Transmitted>,
    /// Goals of the responses, then those of the scatter.
    goals: Vec<Goal>,
}

impl<'a> Wanted<'a> {
    /// Checks responses and goals.
    fn new(fits: &'a [Fit], goals: &[Goal], scatter: &[ScatterGoal]) -> Result<Self, Error> {
        let Some(first) = fits.first().filter(|_| fits.len() == goals.len()) else {
            return Err(Error::Length {
                what: "goals, one per response",
                expected: fits.len(),
                given: goals.len(),
            });
        };
        let symbols = |fit: &Fit| -> Vec<String> {
            let range = |f: &Factor| format!("{} {} to {}", f.symbol(), f.low(), f.high());
            fit.factors.iter().map(range).collect()
        };
        for fit in fits {
            if symbols(fit) != symbols(first) {
                return Err(Error::FactorMismatch {
                    model: symbols(first).join(", "),
                    given: symbols(fit).join(", "),
                });
            }
        }
        goals.iter().try_for_each(Goal::check)?;
        let of_scatter = scatter.iter().map(|s| s.goal);
        Ok(Self {
            fits,
            coefficients: fits.iter().map(Fit::coefficients).collect(),
            scatters: Transmitted::all(fits, scatter)?,
            goals: goals.iter().copied().chain(of_scatter).collect(),
        })
    }

    /// The responses at a coded point, then the standard deviations handed on.
    fn values(&self, x: &[f64]) -> Vec<f64> {
        let mean = |(fit, coefficients): (&Fit, &Vec<f64>)| -> f64 {
            let row = fit.formula.row(x);
            row.iter().zip(coefficients).map(|(t, c)| t * c).sum()
        };
        let means = self.fits.iter().zip(&self.coefficients).map(mean);
        means.chain(self.scatters.iter().map(|s| s.sd(x))).collect()
    }

    /// What the search makes least: less the desirability, or how far the point is from being worth something.
    fn cost(&self, x: &[f64]) -> f64 {
        let values = self.values(x);
        let total = overall(&self.goals, &values);
        if total > 0.0 {
            return -total;
        }
        let goals = self.goals.iter().zip(values);
        goals.map(|(goal, y)| goal.shortfall(y)).sum()
    }

    /// The setting at a coded point with its predictions.
    fn at(&self, coded: Vec<f64>, error: Option<ErrorSource>) -> Result<Compromise, Error> {
        let natural = self.fits[0].natural(&coded);
        let predicted = |fit: &Fit| fit.predict_with(&natural, fit.chosen_error(error)?);
        let predictions = self.fits.iter().map(predicted).collect::<Result<_, _>>()?;
        let values = self.values(&coded);
        let goals = self.goals.iter().zip(&values);
        Ok(Compromise {
            desirability: overall(&self.goals, &values),
            each: goals.map(|(goal, y)| goal.desirability(*y)).collect(),
            transmitted_sd: values[self.fits.len()..].to_vec(),
            coded,
            natural,
            predictions,
        })
    }
}

/// What hands scatter on to a response.
struct Transmitted {
    surface: Quadratic,
    /// Variances of the factors, coded.
    variances: Vec<f64>,
}

impl Transmitted {
    /// Reads the goals of the scatter.
    fn all(fits: &[Fit], scatter: &[ScatterGoal]) -> Result<Vec<Self>, Error> {
        let one = |wanted: &ScatterGoal| {
            wanted.goal.check()?;
            let Some(fit) = fits.get(wanted.response) else {
                return Err(Error::Length {
                    what: "responses",
                    expected: wanted.response + 1,
                    given: fits.len(),
                });
            };
            Ok(Self {
                surface: fit.quadratic()?,
                variances: coded_variances(&fit.factors, &wanted.factor_sd)?,
            })
        };
        scatter.iter().map(one).collect()
    }

    /// Standard deviation handed on at a coded point.
    fn sd(&self, x: &[f64]) -> f64 {
        transmitted_variance(&self.surface, x, &self.variances).sqrt()
    }
}

/// Weighted geometric mean of the desirabilities.
fn overall(goals: &[Goal], values: &[f64]) -> f64 {
    let weight: f64 = goals.iter().map(|g| g.importance).sum();
    let logs = goals
        .iter()
        .zip(values)
        .map(|(g, y)| g.importance * g.desirability(*y).ln());
    (logs.sum::<f64>() / weight).exp()
}

/// Coordinate j of start i: the fractional parts of multiples of irrational numbers.
fn start(i: usize, j: usize) -> f64 {
    let step = ((j + 2) as f64 * 1.618_033_988_749_895).sqrt();
    2.0 * ((i + 1) as f64 * step).fract() - 1.0
}

/// Moves along one factor or two at a time, the steps halving; returns the cost.
fn within_box(x: &mut [f64], cost: &dyn Fn(&[f64]) -> f64) -> f64 {
    let mut reached = cost(x);
    let mut step = 0.5;
    let k = x.len();
    while step > 1e-7 {
        let before = reached;
        for i in 0..k {
            for j in 0..=i {
                for (a, b) in [(step, step), (step, -step), (-step, step), (-step, -step)] {
                    let kept = (x[i], x[j]);
                    x[i] = (x[i] + a).clamp(-1.0, 1.0);
                    if j != i {
                        x[j] = (x[j] + b).clamp(-1.0, 1.0);
                    }
                    let value = cost(x);
                    if value < reached {
                        reached = value;
                    } else {
                        (x[i], x[j]) = (kept.0, kept.1);
                    }
                }
            }
        }
        if reached >= before {
            step *= 0.5;
        }
    }
    reached
}
