//! Answers that are not a single point: branches, open regions, scatter of the nearest solution, and the
//! solution that scattering factors hurt least.

#![expect(
    clippy::unwrap_used,
    reason = "the helpers of tests may fail like tests"
)]

use experiment_design::Factor;
use probability::normal_quantile;
use response_surface::solutions::{bootstrap, most_robust};
use response_surface::{
    Cell, Error, ErrorSource, Fit, Model, Observations, SolutionRequest, fit, solutions,
};

/// A fit of runs over a grid of levels -1, 0, 1, twice each, with alternating noise.
fn fitted(symbols: &str, formula: &str, noise: f64, truth: &dyn Fn(&[f64]) -> f64) -> Fit {
    let factors: Vec<Factor> = symbols
        .chars()
        .map(|c| Factor::coded_only(&c.to_string()).unwrap())
        .collect();
    let k = u32::try_from(factors.len()).unwrap();
    let mut cells = Vec::new();
    for i in 0..3_i32.pow(k) {
        let x: Vec<f64> = (0..k)
            .map(|j| f64::from(i / 3_i32.pow(j) % 3 - 1))
            .collect();
        for sign in [-1.0, 1.0] {
            cells.push(Cell::single(x.clone(), truth(&x) + sign * noise));
        }
    }
    let model = Model::parse(formula, &factors).unwrap();
    fit(&factors, &model, &Observations::from_cells(cells).unwrap()).unwrap()
}

/// A parabola meets a target on two lines, a paraboloid on one circle, and a target that only the
/// corners reach on four arcs.
#[test]
fn separate_parts_of_the_solution_set_are_told_apart() {
    let parabola = fitted("AB", "quadratic", 0.0, &|x| x[0] * x[0]);
    let parts = |fit: &Fit, target: f64| {
        let found = solutions(fit, &SolutionRequest::for_target(target)).unwrap();
        found.branches.unwrap()
    };
    let two = parts(&parabola, 0.25);
    assert_eq!(two.len(), 2);
    let mut places: Vec<f64> = two.iter().map(|part| part.example[0]).collect();
    places.sort_by(f64::total_cmp);
    // Bisection between two corners ends at rounding.
    assert!(
        (places[0] + 0.5).abs() < 1e-9 && (places[1] - 0.5).abs() < 1e-9,
        "{places:?}"
    );
    assert!(
        two.iter().all(|part| part.ranges[1] == [-1.0, 1.0]),
        "{two:?}"
    );
    let bowl = fitted("AB", "quadratic", 0.0, &|x| x[0] * x[0] + x[1] * x[1]);
    assert_eq!(parts(&bowl, 0.5).len(), 1);
    assert_eq!(parts(&bowl, 1.5).len(), 4);
    assert_eq!(parts(&bowl, 2.5).len(), 0);
}

/// On a steep line the data bound the solution on both sides; on one they cannot tell from a flat one
/// they bound nothing.
#[test]
fn a_region_says_at_which_bounds_it_is_open() {
    let open = |slope: f64, noise: f64| {
        let line = fitted("A", "linear", noise, &|x| slope * x[0]);
        let found = solutions(&line, &SolutionRequest::for_target(0.0)).unwrap();
        *found.region.unwrap().open.get("A").unwrap()
    };
    assert_eq!(open(5.0, 0.5), [false, false]);
    assert_eq!(open(0.01, 0.5), [true, true]);
}

/// On a line the solution of a redrawn experiment lies below q with probability
/// `Phi((a + b q - T) / sd(a + b q - T))`: its quantiles are the ends of Fieller's interval with a normal
/// limit. Of 20 000 draws the 2.5 % quantile has a standard error of 0.019 standard deviations of
/// the solution; five of them are allowed.
#[test]
fn redrawn_solutions_have_the_quantiles_of_fieller() {
    let line = fitted("A", "linear", 0.6, &|x| 2.0 * x[0]);
    let request = SolutionRequest {
        target_sd: Some(0.4),
        target_n: Some(4),
        error: Some(ErrorSource::Residual),
        ..SolutionRequest::for_target(0.5)
    };
    let drawn = bootstrap(&line, &request, 20_000, 3).unwrap();
    assert_eq!(drawn.len(), 1, "only the coded metric needs no sd");
    let factor = drawn[0].factors.get("A").unwrap();
    let z = normal_quantile(0.975).unwrap();
    let variance = |q: f64| line.mse.unwrap() * line.leverage(&[q]) + 0.04;
    let end = |z: f64| {
        // The interval ends where the fitted value misses the target by z standard errors.
        (0..200).fold(0.25, |q, _| 0.25 + z * variance(q).sqrt() / 2.0)
    };
    let sd = (end(z) - end(-z)) / (2.0 * z);
    for (got, wanted) in factor.quantiles95.iter().zip([end(-z), end(z)]) {
        assert!(
            (got - wanted).abs() < 0.095 * sd,
            "{factor:?} against {wanted}"
        );
    }
    assert!((factor.median - 0.25).abs() < 0.06 * sd, "{factor:?}");
    assert!(bootstrap(&line, &request, 10, 3).is_err());
}

/// Where the solution is cut at a bound, the bound holds probability instead of an interval.
#[test]
fn bounds_hold_a_share_of_redrawn_solutions() {
    let plane = fitted("AB", "linear", 0.5, &|x| x[0] + 0.2 * x[1]);
    let request = SolutionRequest::for_target(1.1);
    let drawn = bootstrap(&plane, &request, 2000, 1).unwrap();
    let factor = drawn[0].factors.get("A").unwrap();
    assert!(factor.at_high > 0.2 && factor.at_low == 0.0, "{drawn:?}");
    assert!(
        drawn[0].no_solution > 0.05 && drawn[0].no_solution < 0.9,
        "{drawn:?}"
    );
    let exact = fitted("A", "quadratic", 0.0, &|x| x[0]);
    let none = Fit {
        df_resid: 0,
        mse: None,
        pure_error: None,
        ..exact
    };
    assert!(matches!(
        bootstrap(&none, &SolutionRequest::for_target(0.0), 200, 1),
        Err(Error::NoErrorVariance { .. })
    ));
}

/// `y = 2 A + A B` with equal scatter of both: on `y = 1/2` the transmitted variance is
/// `s^2 ((2 + B)^2 + A^2) + s^4`, least where B is -1 and A = 1/2.
#[test]
fn the_most_robust_solution_is_where_the_surface_is_flattest() {
    let surface = fitted("AB", "A + A:B", 0.0, &|x| 2.0 * x[0] + x[0] * x[1]);
    let s = 0.1_f64;
    let robust = most_robust(&surface, 0.5, &[s, s]).unwrap().unwrap();
    assert_eq!(robust.at_bound, ["B"]);
    assert!((robust.coded[0] - 0.5).abs() < 1e-6, "{robust:?}");
    let expected = (s * s * 1.25 + s.powi(4)).sqrt();
    assert!(
        (robust.transmitted_sd - expected).abs() < 1e-6,
        "{robust:?}"
    );
    assert_eq!(most_robust(&surface, 9.0, &[s, s]).unwrap(), None);
    assert!(most_robust(&surface, 0.5, &[s]).is_err());
    assert!(most_robust(&surface, 0.5, &[s, -1.0]).is_err());
}
