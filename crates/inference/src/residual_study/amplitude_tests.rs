//! Amplitudes of effects whose response is straight, saturates or bends upwards: how often their intervals hold the truth.

use super::tests::{measured, outcome, plan, studied, truth};
use super::{ResidualPlan, ResidualStudy, assemble};
use crate::diagnosis::Verdict;
use campaign::{RunOutcome, RunRequest, Simulator, SimulatorError};
use probability::random_stream::Stream;

/// How what "bend" does grows with its amplitude from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Response {
    /// In proportion.
    Straight,
    /// As 1 - exp(-a / l).
    Saturating(f64),
    /// As the square.
    Upwards,
}

/// What "bend" does at an amplitude of 1, over what it does in the simulator of the other tests.
const SIZE: f64 = 2.0;

impl Response {
    /// The response at an amplitude; 1 at an amplitude of 1.
    fn at(self, a: f64) -> f64 {
        match self {
            Self::Straight => a,
            Self::Saturating(length) => (-a / length).exp_m1() / (-1.0 / length).exp_m1(),
            Self::Upwards => a * a,
        }
    }

    /// Angle and shape.
    fn values(self, [rpm, fill]: [f64; 2], [a, b]: [f64; 2], [bend, tilt]: [f64; 2]) -> [f64; 2] {
        truth(rpm, fill, a, b, [SIZE * self.at(bend), tilt])
    }
}

impl Simulator for Response {
    fn version(&self) -> String {
        format!("{self:?}")
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        let at = [request.condition("rpm")?, request.condition("fill")?];
        let parameters = [request.parameter("a")?, request.parameter("b")?];
        let effects = [request.effect("bend"), request.effect("tilt")];
        Ok(outcome(request, self.values(at, parameters, effects)))
    }
}

/// Two runs a mean; "bend" goes from 0 to 1.
fn plan_to_one(seed: u64) -> ResidualPlan {
    let mut plan = plan(seed);
    plan.base.seed = 100_000 * seed;
    plan.replicates = 2;
    (plan.effects[0].probe, plan.effects[0].range) = (0.5, [0.0, 1.0]);
    plan
}

/// Result of some campaigns in which "bend" is hidden.
#[derive(Debug, Default)]
struct Count {
    /// Named alone.
    right: u32,
    tied: u32,
    /// Other effects alone are named.
    wrong: u32,
    /// Something is missing, without a name.
    unknown: u32,
    /// Nothing is missing.
    none: u32,
    /// Of those named alone: the interval of the amplitude holds the truth.
    held: u32,
    /// The truth is above the interval, or below it.
    outside: [u32; 2],
    /// Of those named alone: the error at the kept conditions is no more than noise.
    noise: u32,
    widths: Vec<f64>,
}

impl Count {
    fn add(&mut self, study: &ResidualStudy, amplitude: f64) {
        let d = &study.diagnosis;
        let holds = d.effects.iter().any(|name| name == "bend");
        match d.verdict {
            Verdict::None | Verdict::NotTestable | Verdict::Refused => self.none += 1,
            Verdict::Unknown | Verdict::Recheck => self.unknown += 1,
            Verdict::Named if holds && d.effects.len() == 1 => {
                self.right += 1;
                let [low, high] = d.amplitudes["bend"].interval95;
                self.outside[0] += u32::from(amplitude > high);
                self.outside[1] += u32::from(amplitude < low);
                self.held += u32::from((low..=high).contains(&amplitude));
                self.widths.push(high - low);
                let kept = study.after.as_ref().and_then(|m| m.errors.kept.as_ref());
                let values = study.plan.count(false) * study.plan.observables.len();
                let likely = assemble::likely_mean_square(values);
                self.noise += u32::from(kept.is_some_and(|kept| kept.whitened_mse <= likely));
            }
            _ if holds => self.tied += 1,
            _ => self.wrong += 1,
        }
    }

    fn line(&mut self) -> String {
        self.widths.sort_by(f64::total_cmp);
        let width = self
            .widths
            .get(self.widths.len() / 2)
            .copied()
            .unwrap_or(f64::NAN);
        let share = 100.0 * f64::from(self.held) / f64::from(self.right);
        let [above, below] = self.outside;
        format!(
            "named {} tied {} wrong {} unknown {} none {}; interval holds the truth in {share:.1} % (above it {above}, \
             below it {below}), median width {width:.3}; kept error is noise in {}",
            self.right, self.tied, self.wrong, self.unknown, self.none, self.noise
        )
    }
}

/// Campaigns with a response, the amplitude drawn between two.
fn campaigns(response: Response, [low, high]: [f64; 2], seeds: std::ops::Range<u64>) -> Count {
    let mut count = Count::default();
    for seed in seeds {
        let mut stream = Stream::new(seed, "hidden amplitude");
        let mut between = |low: f64, high: f64| low + (high - low) * stream.uniform();
        let amplitude = between(low, high);
        let parameters = [between(0.4, 1.0), between(0.3, 0.7)];
        let plan = plan_to_one(seed);
        let hidden = [amplitude, 0.0];
        let data = measured(&plan, seed, |rpm, fill| {
            response.values([rpm, fill], parameters, hidden)
        });
        count.add(&studied(&response, &data), amplitude);
    }
    count
}

/// Truths at small, middle and large amplitudes, and at the end of the range.
const TRUTHS: [[f64; 2]; 4] = [[0.15, 0.35], [0.4, 0.6], [0.75, 0.95], [1.0, 1.0]];
const RESPONSES: [Response; 4] = [
    Response::Straight,
    Response::Saturating(0.5),
    Response::Saturating(0.2),
    Response::Upwards,
];

/// Prints how often an effect of each response is named, and how often the interval of its amplitude holds the truth.
#[test]
#[ignore = "minutes; `trials/checks.sh name-campaigns`"]
fn rates_of_amplitudes() {
    let number = 25;
    for (k, response) in (0..).zip(RESPONSES) {
        for (i, truths) in (0..).zip(TRUTHS) {
            let first = 10_000 * (k + 1) + 1000 * i;
            let mut count = campaigns(response, truths, first..first + number);
            println!("{response:?} {truths:?}: {}", count.line());
        }
    }
}
