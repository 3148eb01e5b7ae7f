//! Whether a name is right: effects whose slopes promise what their runs do not keep, and effects that the library lacks.

use super::tests::{By, measured, outcome, plan, studied, truth};
use super::{EffectProbe, ResidualPlan, ResidualStudy};
use crate::diagnosis::Verdict;
use campaign::{RunOutcome, RunRequest, SimulatorError};
use probability::random_stream::Stream;
/// What the two do to angle and shape.
fn pair(rpm: f64, fill: f64, curved: f64, straight: f64) -> [f64; 2] {
    let (slowing, growing) = (1.0 - (-curved).exp(), (curved / 2.0).powi(3));
    let at_4 = (1.0 - (-4.0_f64).exp(), 8.0);
    let share = straight / 2.0;
    [
        0.004 * (rpm * rpm * slowing + at_4.0 * share * rpm.powf(1.5) * 30.0_f64.sqrt()),
        0.5 * fill * fill * (growing + 0.7 * at_4.1 * share),
    ]
}

/// Two effects that both lift angle and shape. "curved" lifts the angle less and less and the shape more and more; "straight"
/// does in proportion almost what "curved" does at 4: their best fits are 2.5 standard deviations apart at the used conditions.
/// By its slopes, at the probe of 2 and at its first look, "curved" leaves 5 standard deviations of itself.
fn pair_run(request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
    let (rpm, fill) = (request.condition("rpm")?, request.condition("fill")?);
    let (a, b) = (request.parameter("a")?, request.parameter("b")?);
    let effect = |name| request.effect(name);
    let [angle, shape] = truth(rpm, fill, a, b, [0.0, effect("tilt")]);
    let [more_angle, more_shape] = pair(rpm, fill, effect("curved"), effect("straight"));
    Ok(outcome(request, [angle + more_angle, shape + more_shape]))
}

/// The plan with these effects in the library.
fn plan_with(names: &[&str], seed: u64) -> ResidualPlan {
    let mut plan = plan(seed);
    let probe = |name: &&str| EffectProbe {
        name: (*name).into(),
        ..plan.effects[0].clone()
    };
    plan.effects = names.iter().map(probe).collect();
    plan
}

/// Result of some campaigns.
#[derive(Debug, Default, PartialEq, Eq)]
struct Count {
    /// The truth named alone.
    right: usize,
    tied: usize,
    /// Effects named, or said to be one of those that are missing, the truth not among them.
    wrong: usize,
    /// Something missing, without a name.
    unknown: usize,
    /// Nothing missing.
    none: usize,
}

impl Count {
    fn add(&mut self, study: &ResidualStudy, hidden: &str) {
        let d = &study.diagnosis;
        let holds = d.effects.iter().any(|name| name == hidden);
        *match d.verdict {
            Verdict::None | Verdict::NotTestable | Verdict::Refused => &mut self.none,
            Verdict::Unknown | Verdict::Recheck => &mut self.unknown,
            Verdict::Named if holds && d.effects.len() == 1 => &mut self.right,
            _ if holds => &mut self.tied,
            _ => &mut self.wrong,
        } += 1;
    }
}

fn campaigns_of_pair(hidden: &str, amplitude: f64, number: u64) -> Count {
    let mut count = Count::default();
    for seed in 1..=number {
        let plan = plan_with(&["curved", "straight", "tilt"], 3000 + seed);
        let (curved, straight) = match hidden {
            "curved" => (amplitude, 0.0),
            _ => (0.0, amplitude),
        };
        let data = measured(&plan, 3000 + seed, |rpm, fill| {
            let [angle, shape] = truth(rpm, fill, 0.7, 0.4, [0.0; 2]);
            let [more_angle, more_shape] = pair(rpm, fill, curved, straight);
            [angle + more_angle, shape + more_shape]
        });
        count.add(&studied(&By(pair_run), &data), hidden);
    }
    count
}

/// Campaigns in which something is hidden that no effect of the library does: a drawn polynomial of speed and fill in both
/// observables, of some five standard deviations.
fn campaigns_outside(number: u64) -> Count {
    let mut count = Count::default();
    for seed in 1..=number {
        let plan = plan_with(&["curved", "straight", "tilt"], 5000 + seed);
        let mut stream = Stream::new(seed, "outside the library");
        let c: Vec<f64> = (0..8).map(|_| 0.35 * stream.normal()).collect();
        let data = measured(&plan, 5000 + seed, |rpm, fill| {
            let [angle, shape] = truth(rpm, fill, 0.7, 0.4, [0.0; 2]);
            let (x, y) = ((rpm - 15.0) / 12.0, (fill - 0.3) / 0.1);
            let hidden = |c: &[f64]| c[0] * x + c[1] * x * x + c[2] * x * y + c[3] * y * y;
            [angle + hidden(&c[..4]), shape + hidden(&c[4..])]
        });
        count.add(&studied(&By(pair_run), &data), "none of them");
    }
    count
}

/// Of 24 campaigns in which "curved" is hidden, whose slopes promise less than those of its rival, real runs leave no wrong name but by
/// chance: of any rate of 5 % at most, 4 or fewer wrong ones come in 99 of 100 cases; by the slopes alone 25 % are wrong, 50 of 200
/// campaigns. The truth is named or tied in most: 88 % of 100 campaigns, 17 or more of 24 in 99 of 100 cases; by the slopes 22 %.
#[test]
fn a_name_is_not_given_for_what_slopes_promise() {
    let count = campaigns_of_pair("curved", 4.0, 24);
    assert!(count.wrong <= 4, "{count:?}");
    assert!(count.right + count.tied >= 17, "{count:?}");
}

/// Of 24 campaigns in which something is hidden that the library lacks, 4 or fewer give a name, as 99 of 100 would with a rate of 5 %.
#[test]
fn what_the_library_lacks_gets_no_name() {
    let count = campaigns_outside(24);
    assert!(count.wrong <= 4, "{count:?}");
    assert!(count.unknown >= 12, "{count:?}");
}

/// Prints how often names are right and wrong.
#[test]
#[ignore = "minutes; `trials/checks.sh name-campaigns`"]
fn rates_of_names() {
    println!("curved hidden: {:?}", campaigns_of_pair("curved", 4.0, 100));
    println!(
        "straight hidden: {:?}",
        campaigns_of_pair("straight", 2.0, 100)
    );
    println!("outside the library: {:?}", campaigns_outside(100));
}
