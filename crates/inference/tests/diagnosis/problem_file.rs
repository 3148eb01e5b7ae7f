//! Problem files: what is refused with its place, and what survives writing and reading.

use crate::behaviour::{design, diagnosed, with_effect};
use inference::diagnosis::{Condition, CovarianceInput, Error, Level, Problem, ProblemFile, Sign};

#[test]
fn numbers_that_are_not_finite_are_refused_with_their_place() {
    let mut file = design();
    file.sensitivities_library[3][1] = f64::NAN;
    let error = Problem::try_from(file).unwrap_err();
    assert!(
        error.to_string().contains("sensitivities_library[3][1]"),
        "{error}"
    );
}

/// The square of 1e308 is not finite: it ended as a covariance that is not positive definite, or as an answer.
#[test]
fn numbers_whose_squares_are_not_finite_are_refused_with_their_place() {
    let mut file = design();
    file.sensitivities_library[3][1] = 1e308;
    let slope = Problem::try_from(file).unwrap_err().to_string();
    let mut file = design();
    file.residual_obs_minus_sim[2] = Some(-1e308);
    let residual = Problem::try_from(file).unwrap_err().to_string();
    for (told, place) in [
        (slope, "sensitivities_library[3][1]"),
        (residual, "residual"),
    ] {
        assert!(
            told.contains(place) && told.contains("1e308") && told.contains("1e100"),
            "{told}"
        );
    }
}

#[test]
fn wrong_lengths_and_unknown_names_are_refused() {
    let mut file = design();
    file.sensitivities_declared.pop();
    let error = Problem::try_from(file).unwrap_err();
    assert!(
        matches!(
            error,
            Error::WrongLength {
                found: 23,
                expected: 24,
                ..
            }
        ),
        "{error}"
    );
    let mut file = design();
    file.signs.insert("wind".into(), Sign::Positive);
    let error = Problem::try_from(file).unwrap_err();
    assert!(matches!(error, Error::BadName { .. }), "{error}");
}

/// The raw form survives writing and reading; a key without meaning gives a warning.
#[test]
fn problem_file_can_be_written_and_read() {
    let file = with_effect(1, 0.5, 9);
    let text = serde_json::to_string(&file).expect("all numbers are finite");
    let read: ProblemFile = serde_json::from_str(&text).expect("it was just written");
    assert_eq!(read.conditions, file.conditions);
    assert_eq!(read.cov_simulator, file.cov_simulator);
    let odd = text.replacen('{', "{\"colour\": \"red\", ", 1);
    let read: ProblemFile = serde_json::from_str(&odd).expect("unknown keys are not an error");
    let d = diagnosed(read);
    assert!(d.warnings[0].contains("colour"), "{:?}", d.warnings);
}

#[test]
fn shares_of_errors_that_fit_no_parameter_are_refused() {
    let file = ProblemFile {
        cov_sensitivities_declared_along: vec![vec![1.0, 0.0, 0.0]],
        ..ProblemFile::default()
    };
    let error = Problem::try_from(ProblemFile {
        conditions: vec![Condition::from([("rpm".into(), Level::Number(4.0))])],
        observables: vec!["angle_deg".into()],
        residual_obs_minus_sim: vec![Some(1.0)],
        cov_measurement: Some(CovarianceInput::Matrix(vec![vec![1.0]])),
        cov_simulator: Some(CovarianceInput::Matrix(vec![vec![0.0]])),
        sensitivities_declared: vec![vec![1.0]],
        declared: vec!["a".into()],
        cov_sensitivities_declared: vec![CovarianceInput::Matrix(vec![vec![1.0]])],
        ..file
    })
    .unwrap_err()
    .to_string();
    assert!(
        error.contains("cov_sensitivities_declared_along"),
        "{error}"
    );
}
