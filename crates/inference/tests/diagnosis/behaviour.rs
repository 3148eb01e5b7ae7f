//! Rules of the diagnosis on a small design of its own, with planted defects.

use inference::diagnosis::{
    Condition, CovarianceInput, Error, ExperimentFile, Largest, Level, Options, PriorPrecision,
    Problem, ProblemFile, Sign, Truth, Verdict, diagnose, trials, usual_truths,
};
use probability::random_stream::Stream;

/// Conditions: 4 speeds x 3 fillings.
const CONDITIONS: usize = 12;
/// Options with enough draws for verdicts that are not close to a limit.
const OPTIONS: Options = Options {
    seed: 5,
    draws: 20_000,
    max_effects: 2,
};

/// Speed and filling of a condition, both scaled to -1..1.
fn place(condition: usize) -> (f64, f64) {
    (
        (condition % 4) as f64 / 1.5 - 1.0,
        (condition / 4) as f64 - 1.0,
    )
}

/// Two observables, two declared parameters, three effects (not smooth polynomials of low degree,
/// so that an unknown smooth effect is a poor rival), noise of variance 0.04 + 0.04, no residual.
pub(crate) fn design() -> ProblemFile {
    let mut file = ProblemFile {
        observables: vec!["angle_deg".into(), "height_mm".into()],
        library: vec!["slip".into(), "cohesion".into(), "drag".into()],
        cov_measurement: Some(diagonal(0.04)),
        cov_simulator: Some(diagonal(0.04)),
        ..ProblemFile::default()
    };
    for c in 0..CONDITIONS {
        let (speed, fill) = place(c);
        file.conditions.push(Condition::from([
            (
                "rpm".into(),
                Level::Number(4.0 * [1.0, 2.0, 4.0, 8.0][c % 4]),
            ),
            ("fill".into(), Level::Number(0.3 + 0.1 * fill)),
        ]));
        for o in 0..2 {
            let (a, b) = if o == 0 { (1.0, 0.3) } else { (-0.4, 1.0) };
            file.residual_obs_minus_sim.push(Some(0.0));
            file.sensitivities_declared
                .push(vec![a, b * (1.0 + 0.5 * speed)]);
            file.sensitivities_library.push(vec![
                a * (3.0 * speed).sin() * (1.0 + fill),
                b * (2.5 * speed + 1.5 * fill).cos(),
                a * speed * fill - b * speed * speed * fill,
            ]);
        }
    }
    file
}

/// A shared block of two uncorrelated observables.
fn diagonal(variance: f64) -> CovarianceInput {
    CovarianceInput::Matrix(vec![vec![variance, 0.0], vec![0.0, variance]])
}

/// The design with noise of its covariance, and an effect of this amplitude.
pub(crate) fn with_effect(effect: usize, amplitude: f64, seed: u64) -> ProblemFile {
    let mut file = design();
    let mut noise = Stream::new(seed, "test noise");
    for (r, row) in file
        .residual_obs_minus_sim
        .iter_mut()
        .zip(&file.sensitivities_library)
    {
        *r = Some(row[effect] * amplitude + 0.08_f64.sqrt() * noise.normal());
    }
    file
}

/// Keeps conditions for the check that repeat the used ones.
fn repeat_as_unused(file: &mut ProblemFile) {
    file.unused_conditions.clone_from(&file.conditions);
    file.unused_residual_obs_minus_sim
        .clone_from(&file.residual_obs_minus_sim);
    file.unused_sensitivities_declared
        .clone_from(&file.sensitivities_declared);
    file.unused_sensitivities_library
        .clone_from(&file.sensitivities_library);
}

/// Diagnoses a raw problem that is sound.
pub(crate) fn diagnosed(file: ProblemFile) -> inference::diagnosis::Diagnosis {
    let problem = Problem::try_from(file).expect("the problem is sound");
    diagnose(&problem, &OPTIONS).expect("its covariances can be factorised")
}

/// An interval without width, because no amplitude passes the test, is not printed as one that knows the amplitude to all digits.
#[test]
fn an_interval_without_width_is_none() {
    let said = |interval95| {
        let value = 0.173;
        inference::diagnosis::Amplitude { value, interval95 }.to_string()
    };
    assert_eq!(said([0.11, 0.2]), "0.173 (0.110 to 0.200)");
    assert_eq!(said([0.173, 0.173]), "0.173 (no amplitude passes at 95 %)");
}

/// 400 campaigns of each truth: a rate of 0.05 is met within three standard errors, 0.033. A hidden
/// effect of 7 standard errors is lost to the naming rules in few cases, and wrongly replaced by
/// another in hardly any (bound by the rule: 0.05 of the namings). An effect that the library lacks
/// is not given a name of the library, within the same 0.033 of the 2 % that the rule aims at.
#[test]
fn rules_err_as_seldom_as_promised_when_the_truth_is_known() {
    let problem = Problem::try_from(design()).expect("the design is sound");
    let truths = usual_truths(&problem, 7.0).expect("it can be fitted");
    for row in trials(&problem, &truths, 400, 3, 0).expect("it can be simulated") {
        let share = |count: usize| count as f64 / row.trials as f64;
        let sum = row.none + row.named + row.tied + row.false_name + row.unknown + row.recheck;
        assert_eq!(sum, row.trials);
        match &row.truth {
            Truth::Nothing => {
                assert!(row.alarm() < 0.05 + 0.033, "{row:?}");
                assert!(row.alarm() > 0.01, "{row:?}");
            }
            Truth::Effect { .. } => {
                assert!(share(row.named + row.tied) > 0.8, "{row:?}");
                let right = row.truth_in_named_set().expect("namings");
                assert!(right > 0.95, "{row:?}");
            }
            Truth::TakenOut { .. } | Truth::Outsider { .. } => {
                assert!(share(row.false_name) < 0.02 + 0.033, "{row:?}");
            }
            Truth::BadValue { .. } => assert!(share(row.false_name) < 0.05, "{row:?}"),
            Truth::TwoEffects { .. } => {
                assert!(row.alarm() > 0.95, "{row:?}");
                assert!(share(row.false_name) < 0.05, "{row:?}");
            }
        }
    }
}

/// Each truth is drawn from numbers of its own: threads change no bit.
#[test]
fn threads_change_no_drawn_campaign() {
    let problem = Problem::try_from(design()).expect("the design is sound");
    let truths = usual_truths(&problem, 5.0).expect("it can be fitted");
    let drawn = |threads| trials(&problem, &truths, 10, 7, threads).expect("it can be simulated");
    assert_eq!(drawn(1), drawn(3));
}

/// The unused conditions repeat the used ones. An effect of strength s is s standard deviations of what p = 2
/// re-tuned parameters cannot absorb, spread over n = 24 rows, and a fit adds the scatter of what it fits: the
/// whitened mean square is 1 + (s^2 + p) / n without the effect and 1 + (p + 1) / n with it. By chi square its
/// standard error over 200 campaigns is sqrt(2 / n / 200) = 0.02 with the effect, and 0.06 without, where
/// 2 s sqrt(n) / n of the noise comes in; four of them are allowed.
#[test]
fn a_rightly_named_effect_leaves_noise_on_unused_conditions() {
    let mut file = design();
    repeat_as_unused(&mut file);
    let problem = Problem::try_from(file).expect("the design is sound");
    let truth = Truth::Effect {
        name: "slip".into(),
        strength: 9.0,
    };
    let rows = trials(&problem, &[truth], 200, 3, 0).expect("it can be simulated");
    let errors = rows[0].unused.expect("there are unused conditions");
    assert!(errors.namings > 180, "{errors:?}");
    assert!(
        (errors.before - (1.0 + 83.0 / 24.0)).abs() < 0.24,
        "{errors:?}"
    );
    assert!(
        (errors.after - (1.0 + 3.0 / 24.0)).abs() < 0.08,
        "{errors:?}"
    );
}

/// The residual has variance 0.08 per row; told only 0.02 of it, nearly every set of noise looks
/// structured (T0 is 4 times its degrees of freedom).
#[test]
fn simulator_noise_left_out_gives_false_alarms() {
    let alarms = (0..40)
        .filter(|&seed| {
            let mut file = with_effect(0, 0.0, seed);
            file.cov_measurement = Some(diagonal(0.02));
            file.cov_simulator = Some(diagonal(0.0));
            diagnosed(file).verdict != Verdict::None
        })
        .count();
    assert!(alarms >= 38, "{alarms} of 40");
}

#[test]
fn simulator_covariance_must_be_given() {
    let mut file = design();
    file.cov_simulator = None;
    let error = Problem::try_from(file).unwrap_err();
    assert!(
        matches!(&error, Error::Missing { what, .. } if what == "cov_simulator"),
        "{error}"
    );
}

#[test]
fn effect_of_the_impossible_sign_is_not_named() {
    let mut file = with_effect(0, -1.0, 1);
    assert_eq!(diagnosed(file.clone()).effects, ["slip"]);
    file.signs.insert("slip".into(), Sign::Positive);
    let d = diagnosed(file);
    assert!(!d.effects.contains(&"slip".to_owned()), "{}", d.summary);
    assert_eq!(d.candidates["slip"].amplitude, Some(0.0));
    assert_eq!(d.candidates["slip"].p_max_test, Some(1.0));
}

#[test]
fn effect_that_retuning_imitates_is_not_testable_rather_than_absent() {
    let mut file = with_effect(0, 0.0, 2);
    for (l, s) in file
        .sensitivities_library
        .iter_mut()
        .zip(&file.sensitivities_declared)
    {
        l.truncate(1);
        l[0] = 2.0 * s[0] - s[1];
    }
    file.library.truncate(1);
    let d = diagnosed(file);
    assert_eq!(d.verdict, Verdict::NotTestable, "{}", d.summary);
    assert_eq!(d.not_testable, ["slip"]);
    assert_eq!(d.candidates["slip"].z, None);
}

/// An effect that re-tuning imitates but for a thousandth of its sum of squares would have to be a hundred standard errors
/// large before it is seen at three: nothing can be said about it, in whatever unit its amplitude is. At a hundredth it can.
#[test]
fn effect_that_retuning_imitates_but_for_a_thousandth_is_not_testable() {
    for unit in [1e-4, 1.0, 1e4] {
        for (left, testable) in [(1e-3, false), (1e-2, true)] {
            let mut file = with_effect(0, 0.0, 2);
            let whole = diagnosed(file.clone()).candidates["slip"];
            let share = 1.0 - whole.absorbed_fraction.unwrap();
            let imitated: f64 = 1.0 / left - 1.0;
            // Slip has `share` of its square outside re-tuning; a multiple of a declared column hides that.
            let norm = |column: &dyn Fn(usize) -> f64| {
                (0..2 * CONDITIONS).map(|i| column(i).powi(2)).sum::<f64>()
            };
            let slip = norm(&|i| file.sensitivities_library[i][0]) * share;
            let declared = norm(&|i| file.sensitivities_declared[i][0]);
            let scale = (imitated * slip / declared).sqrt();
            for (l, s) in file
                .sensitivities_library
                .iter_mut()
                .zip(&file.sensitivities_declared)
            {
                l[0] = (l[0] + scale * s[0]) * unit;
            }
            let d = diagnosed(file);
            let absorbed = d.candidates["slip"].absorbed_fraction.unwrap();
            assert!(
                absorbed > 1.0 - 2.0 * left && absorbed < 1.0 - 0.3 * left,
                "{absorbed}"
            );
            assert_eq!(
                d.candidates["slip"].testable, testable,
                "{unit}: {absorbed}"
            );
        }
    }
}

/// With |u| known from the se, an effect with `|u| a_max` below 3 is not testable.
#[test]
fn effect_smaller_than_the_noise_is_not_testable() {
    let mut file = with_effect(0, 0.0, 2);
    let se = diagnosed(file.clone()).candidates["drag"].se.unwrap();
    file.largest_amplitudes
        .insert("drag".into(), Largest::Size(2.9 * se));
    let d = diagnosed(file.clone());
    assert_eq!(d.not_testable, ["drag"]);
    assert_eq!(d.candidates["drag"].p_max_test, None);
    file.largest_amplitudes
        .insert("drag".into(), Largest::Size(3.1 * se));
    assert!(diagnosed(file).not_testable.is_empty(), "s is above 3");
}

/// The truth is named while its amplitude is possible. Where only a third of it is, nine tenths of the
/// residual's distance stay: the effect alone is not named, and its amplitude is that third.
/// An effect like the planted one, whose sensitivity is off by more than a tie allows but leaves no more than noise: runs would
/// refute it, and if none could be made nothing has. One that leaves structure is refuted all the same, and so is one that
/// does not help.
#[test]
fn an_effect_that_could_not_be_run_is_not_passed_over() {
    let like_slip = |k: f64| {
        let mut file = with_effect(0, 1.5, 4);
        for row in &mut file.sensitivities_library {
            row[2] = row[0] + k * row[1];
        }
        file
    };
    for (k, leaves_noise) in [(0.3, true), (0.7, false)] {
        let mut file = like_slip(k);
        let known = diagnosed(file.clone());
        assert_eq!(known.effects, ["slip"], "{k}");
        let p = known.candidates["drag"].p_adequacy.unwrap();
        assert_eq!(p > 0.05, leaves_noise, "{k}: {p}");
        file.not_run = vec!["drag".into()];
        let found = diagnosed(file.clone());
        let expected: &[&str] = if leaves_noise {
            &["slip", "drag"]
        } else {
            &["slip"]
        };
        assert_eq!(found.effects, expected, "{k}");
        let tied = found.verdict == Verdict::Tie;
        assert_eq!(tied, leaves_noise, "{k}: {:?}", found.verdict);
        file.not_run = vec!["wind".into()];
        let refused = Problem::try_from(file).unwrap_err().to_string();
        assert!(
            refused.contains("not_run") && refused.contains("wind"),
            "{refused}"
        );
    }
}

#[test]
fn an_effect_beyond_what_is_possible_explains_nothing() {
    let mut file = with_effect(0, 0.0, 4);
    let se = diagnosed(file.clone()).candidates["slip"].se.unwrap();
    file = with_effect(0, 12.0 * se, 4);
    file.largest_amplitudes
        .insert("slip".into(), Largest::Size(20.0 * se));
    let possible = diagnosed(file.clone());
    assert_eq!(possible.effects, ["slip"], "{}", possible.summary);
    file.largest_amplitudes
        .insert("slip".into(), Largest::Size(4.0 * se));
    let held = diagnosed(file);
    assert_ne!(held.verdict, Verdict::Named, "{}", held.summary);
    let amplitude = held.candidates["slip"].amplitude.unwrap();
    assert!((amplitude / (4.0 * se) - 1.0).abs() < 1e-9, "{amplitude}");
}

/// A friction may be three times as large and never below zero: the end on the side that the data ask for counts, not
/// the farther one.
#[test]
fn each_side_of_an_amplitude_has_its_own_limit() {
    let mut file = with_effect(0, 0.0, 4);
    let se = diagnosed(file.clone()).candidates["slip"].se.unwrap();
    let ends = Largest::Ends([-4.0 * se, 20.0 * se]);
    let with = |times: f64| {
        let mut file = with_effect(0, times * se, 4);
        file.largest_amplitudes.insert("slip".into(), ends);
        diagnosed(file)
    };
    let possible = with(12.0);
    assert_eq!(possible.effects, ["slip"], "{}", possible.summary);
    let held = with(-12.0);
    assert_ne!(held.verdict, Verdict::Named, "{}", held.summary);
    let amplitude = held.candidates["slip"].amplitude.unwrap();
    assert!((amplitude / (-4.0 * se) - 1.0).abs() < 1e-9, "{amplitude}");
    file.largest_amplitudes
        .insert("slip".into(), Largest::Ends([1.0, 2.0]));
    assert!(Problem::try_from(file).is_err(), "0 must be possible");
}

/// One reading is 12 standard deviations off: no effect is named, the condition is.
#[test]
fn one_condition_that_carries_the_residual_is_to_be_measured_again() {
    let mut file = with_effect(0, 0.0, 3);
    file.residual_obs_minus_sim[2 * 6] = Some(12.0 * 0.08_f64.sqrt());
    let d = diagnosed(file);
    assert_eq!(d.verdict, Verdict::Recheck, "{}", d.summary);
    assert_eq!(d.recheck_condition.as_deref(), Some("fill 0.3, rpm 16"));
}

/// A prior as sharp as the noise on both parameters adds two rows, and rank 2 stays: df grows by
/// 2; an offset of three prior standard deviations then adds to T0, unless the data want it.
#[test]
fn prior_of_the_declared_parameters_counts_as_observations() {
    let mut file = design();
    let free = diagnosed(file.clone()).structured_residual;
    file.prior_precision = Some(PriorPrecision::Diagonal(vec![1e6, 1e6]));
    file.prior_offset = vec![0.0, 0.003];
    let held = diagnosed(file.clone()).structured_residual;
    assert_eq!(held.df, free.df + 2);
    // The data (precision of order 100) hardly resist the prior (10^6): T0 stays far below 9.
    assert!(held.t0.unwrap() < 0.1, "{held:?}");
    file.prior_precision = Some(PriorPrecision::Matrix(vec![vec![1e6, 0.0], vec![0.0, 1e6]]));
    let matrix = diagnosed(file).structured_residual;
    assert!((matrix.t0.unwrap() - held.t0.unwrap()).abs() < 1e-9);
}

/// Sensitivities as noisy as they are large: the variance added for a re-tuning of one unit
/// explains a residual that exact sensitivities cannot.
#[test]
fn noise_of_the_sensitivities_widens_the_covariance() {
    let mut file = with_effect(0, 0.0, 4);
    let mut error = Stream::new(9, "sensitivity error");
    for (r, s) in file
        .residual_obs_minus_sim
        .iter_mut()
        .zip(&file.sensitivities_declared)
    {
        let shifted = 3.0 * (s[0] + 0.2 * error.normal());
        *r = r.map(|r| r + shifted);
    }
    let exact = diagnosed(file.clone()).structured_residual.p.unwrap();
    file.cov_sensitivities_declared = vec![diagonal(0.04), diagonal(0.0)];
    let noisy = diagnosed(file).structured_residual.p.unwrap();
    assert!(exact < 1e-4 && noisy > 0.01, "{exact} {noisy}");
}

/// F has heavier tails than chi2, and tends to it.
#[test]
fn estimated_covariance_makes_the_test_more_cautious() {
    let mut file = with_effect(0, 0.3, 5);
    let p = |file: &ProblemFile| diagnosed(file.clone()).structured_residual.p.unwrap();
    let known = p(&file);
    file.covariance_dof = Some(20.0);
    assert!(p(&file) > known, "{known}");
    file.covariance_dof = Some(1e9);
    assert!((p(&file) / known - 1.0).abs() < 1e-4, "{known}");
}

#[test]
fn observable_that_was_not_measured_is_left_out() {
    let mut file = with_effect(0, 0.0, 6);
    let all = diagnosed(file.clone()).structured_residual.df;
    file.residual_obs_minus_sim[3] = None;
    assert_eq!(diagnosed(file).structured_residual.df, all - 1);
}

/// Two true effects at once: both are found, none alone is adequate, and their amplitudes are reported as they are together.
#[test]
fn two_missing_effects_are_found_together() {
    let mut file = with_effect(0, 1.2, 7);
    for (r, l) in file
        .residual_obs_minus_sim
        .iter_mut()
        .zip(&file.sensitivities_library)
    {
        *r = r.map(|r| r + 1.2 * l[1]);
    }
    let d = diagnosed(file);
    assert_eq!(d.verdict, Verdict::Named, "{}", d.summary);
    assert_eq!(d.effects, ["slip", "cohesion"]);
    // Alone, each carries part of the other; together they are the truth within three standard errors.
    for name in ["slip", "cohesion"] {
        let amplitude = d.amplitudes[name];
        let [low, high] = amplitude.interval95;
        // 1.5 times the half of the interval.
        let far = 0.75 * (high - low);
        assert!((amplitude.value - 1.2).abs() < far, "{name} {amplitude}");
        // Three digits of the amplitude and of its interval.
        let [a, low, high] =
            [amplitude.value, low, high].map(|x| input::quantity::significant(x, 3));
        let told = format!("{name} with amplitude {a} ({low} to {high})");
        assert!(d.summary().contains(&told), "{told} in: {}", d.summary());
        let alone = d.candidates[name].amplitude.unwrap();
        assert!(
            (alone - amplitude.value).abs() > 1e-3,
            "the two overlap: {alone}"
        );
    }
    assert!(d.summary().contains(" are missing: "), "{}", d.summary());
}

/// The unused conditions carry the opposite of the effect: the naming is taken back.
#[test]
fn naming_that_fails_on_unused_conditions_is_withdrawn() {
    let mut file = with_effect(0, 1.0, 8);
    repeat_as_unused(&mut file);
    let sign = |file: &mut ProblemFile, a: f64| {
        file.unused_residual_obs_minus_sim = file
            .residual_obs_minus_sim
            .iter()
            .map(|r| r.map(|r| a * r))
            .collect();
    };
    sign(&mut file, 1.0);
    assert_eq!(diagnosed(file.clone()).effects, ["slip"]);
    sign(&mut file, -1.0);
    let mut planned = file.clone();
    planned.unused_residual_obs_minus_sim.fill(None);
    let open = diagnosed(planned);
    assert_eq!(
        open.effects,
        ["slip"],
        "nothing was measured: {}",
        open.summary
    );
    let d = diagnosed(file);
    assert_eq!(d.verdict, Verdict::Unknown, "{}", d.summary);
    assert_eq!(d.suspects, ["slip"]);
}

/// Two twins of the hidden effect, one with a fortieth of another effect mixed in, one with a tenth, and no noise:
/// a tie begins with the effect that made the data and continues with the nearer twin, whatever the order of the
/// library.
#[test]
fn a_tie_begins_with_the_best_effect_and_goes_on_by_likeness() {
    let mut file = design();
    file.library = vec!["far twin".into(), "truth".into(), "near twin".into()];
    for (r, row) in file
        .residual_obs_minus_sim
        .iter_mut()
        .zip(&mut file.sensitivities_library)
    {
        let (truth, other) = (row[0], row[2]);
        *row = vec![truth + other / 10.0, truth, truth + other / 40.0];
        *r = Some(truth);
    }
    let d = diagnosed(file);
    assert_eq!(d.verdict, Verdict::Tie, "{}", d.summary);
    assert_eq!(d.tie_groups, [["truth", "near twin", "far twin"]]);
}

/// An effect that is itself smooth, without noise: at s = 4 an unknown smooth effect is nearly as
/// likely (a handful of free columns costs less than ln 100), at s = 9 it is not.
#[test]
fn effect_that_an_unknown_one_could_be_is_named_only_when_strong() {
    let mut file = design();
    for (i, row) in file.sensitivities_library.iter_mut().enumerate() {
        row[0] = place(i / 2).0 * [1.0, 0.8][i % 2];
    }
    let se = diagnosed(file.clone()).candidates["slip"].se.unwrap();
    let at = |strength: f64| {
        let mut file = file.clone();
        for (r, l) in file
            .residual_obs_minus_sim
            .iter_mut()
            .zip(&file.sensitivities_library)
        {
            *r = Some(l[0] * se * strength);
        }
        diagnosed(file)
    };
    let weak = at(4.0);
    assert_eq!(weak.verdict, Verdict::Unknown, "{}", weak.summary);
    assert_eq!(weak.suspects, ["slip"]);
    // The factor as it is in the candidate, in two digits.
    let factor = weak.candidates["slip"].ln_bf_unknown.unwrap().exp();
    assert!((1.0..100.0).contains(&factor), "{factor}");
    let factor = input::quantity::significant(factor, 2);
    let said = format!("explains the residual {factor} times as well");
    assert!(weak.summary.contains(&said), "{}", weak.summary);
    assert_eq!(at(9.0).effects, ["slip"]);
}

/// Twins that differ by 2 %: the experiment in which they differ is proposed, though the other
/// sees both of them more strongly; at ten times its cost it still is, having all the use.
#[test]
fn experiment_in_which_tied_effects_differ_is_proposed() {
    let mut file = with_effect(0, 1.0, 10);
    for (i, row) in file.sensitivities_library.iter_mut().enumerate() {
        row[2] = row[0] * (1.0 + 0.02 * place(i / 2).0);
    }
    let offer = |name: &str, slip: f64, drag: f64, cost: f64| ExperimentFile {
        name: Some(name.into()),
        condition: Condition::new(),
        sensitivities_declared: vec![vec![0.0, 0.0]],
        sensitivities_library: vec![vec![slip, 0.0, drag]],
        covariance: vec![vec![0.08]],
        effects: None,
        runs: None,
        cost,
    };
    file.candidate_experiments = vec![
        offer("blind", 5.0, 5.0, 1.0),
        offer("telling", 2.0, -1.0, 10.0),
    ];
    let d = diagnosed(file);
    assert_eq!(d.effects, ["slip", "drag"], "{}", d.summary);
    let next = d.next_measurement.expect("a proposal");
    assert_eq!(next.plan[0].experiment, "telling");
    assert!(next.reached, "{next:?}");
}

/// A slope over four speeds, (-1.5, -0.5, 0.5, 1.5) with a free level: |u|² = 5 outside the level, and noise of
/// variance v in each entry adds 3 v to it. The smallest amplitude that would be seen grows by 5 / (5 - 3 v); with v = 2
/// the slope does not stand out of its noise, and there is none. Rounding only: the critical score is the same.
#[test]
fn noise_of_a_sensitivity_is_no_power() {
    let smallest = |variance: Option<f64>| {
        let mut file: ProblemFile = serde_json::from_str(
            r#"{
            "id": "slope", "observables": ["angle_deg"],
            "conditions": [{"rpm": 5}, {"rpm": 10}, {"rpm": 15}, {"rpm": 20}],
            "residual_obs_minus_sim": [0.3, -0.6, 0.2, 0.1],
            "cov_measurement": [[1.0]], "cov_simulator": [[0.0]],
            "sensitivities_declared": [[1], [1], [1], [1]],
            "library": ["slope"], "sensitivities_library": [[-1.5], [-0.5], [0.5], [1.5]]
        }"#,
        )
        .unwrap();
        file.cov_sensitivities_library
            .extend(variance.map(|v| CovarianceInput::Matrix(vec![vec![v]])));
        let d = diagnose(&Problem::try_from(file).unwrap(), &OPTIONS).unwrap();
        d.candidates["slope"].smallest_detectable
    };
    let known = smallest(None).unwrap();
    let noisy = smallest(Some(0.5)).unwrap();
    assert!(
        (noisy / known - 5.0 / 3.5).abs() < 1e-12,
        "{noisy} and {known}"
    );
    assert_eq!(smallest(Some(2.0)), None);
}

/// Two parameters that raise both values alike, with slopes that err by 1 at most against each other: the shift that the
/// data ask for, 2 in the sum, goes along a way on which these errors cancel, so that the residual of 5 standard errors
/// stays, exactly. Were the errors independent, a shift of 1 in each would bring two variances more, 4 + 2 for 4 in each
/// value, and the sum of squares falls by that ratio.
#[test]
fn errors_of_slopes_that_cancel_along_a_shift_forgive_nothing() {
    let t = |along: Vec<Vec<f64>>| {
        let file = ProblemFile {
            conditions: vec![Condition::from([("rpm".into(), Level::Number(4.0))])],
            observables: ["toe_deg", "top_deg"].map(String::from).to_vec(),
            residual_obs_minus_sim: vec![Some(100.0 + 10.0), Some(100.0 - 10.0)],
            cov_measurement: Some(CovarianceInput::Matrix(vec![
                vec![4.0, 0.0],
                vec![0.0, 4.0],
            ])),
            cov_simulator: Some(CovarianceInput::Matrix(vec![vec![0.0; 2]; 2])),
            declared: vec!["a".into(), "b".into()],
            sensitivities_declared: vec![vec![50.0; 2]; 2],
            // The same for both, so that the shift is shared alike.
            prior_precision: Some(PriorPrecision::Diagonal(vec![1e-8; 2])),
            cov_sensitivities_declared: vec![
                CovarianceInput::Matrix(vec![
                    vec![1.0, 0.0],
                    vec![0.0, 1.0]
                ]);
                2
            ],
            cov_sensitivities_declared_along: along,
            ..ProblemFile::default()
        };
        let problem = Problem::try_from(file).unwrap();
        let diagnosis = diagnose(&problem, &OPTIONS).unwrap();
        diagnosis.structured_residual.t0.unwrap()
    };
    let against = t(vec![vec![1.0, -1.0], vec![0.0, 0.0]]);
    assert!((against - 2.0 * 25.0).abs() < 1e-4, "{against}");
    let independent = t(Vec::new());
    assert!(
        (independent - 50.0 * 4.0 / 6.0).abs() < 1e-3,
        "{independent}"
    );
}
