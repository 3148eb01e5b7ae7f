//! Surfaces of a known quadratic.

use super::{Degree, Surface};
use crate::region::Region;
use crate::samples::Sample;
use std::collections::BTreeMap;

pub(super) fn region() -> Region {
    Region {
        low: vec![0.0, 10.0],
        high: vec![2.0, 30.0],
    }
}

pub(super) fn sample(a: f64, b: f64, noise: f64) -> Sample {
    Sample {
        place: 0,
        at: vec![a, b],
        factor: 1.0,
        values: BTreeMap::from([("y".to_owned(), 1.0 + a * a - 0.1 * a * b + noise)]),
        regime: String::new(),
        key: format!("{a} {b} {noise}"),
    }
}

pub(super) fn grid() -> Vec<Sample> {
    let levels = [0.0, 1.0, 2.0];
    let cells = levels.into_iter().flat_map(|a| {
        let b = [10.0, 20.0, 30.0];
        b.into_iter().map(move |b| sample(a, b, 0.0))
    });
    cells.collect()
}

fn fitted(samples: &[Sample]) -> Surface {
    let all: Vec<_> = samples.iter().collect();
    let names = ["y".to_owned()];
    Surface::fit(
        (0, &[0, 1], &[]),
        &names,
        &region(),
        &all,
        Degree::Quadratic,
    )
    .unwrap()
}

/// The polynomial itself comes back, and its derivatives 2 a - 0.1 b and -0.1 a in natural units, to rounding.
#[test]
fn a_quadratic_is_reproduced_with_its_slopes_in_natural_units() {
    let surface = fitted(&grid());
    let at = [0.7, 14.0];
    let exact = 1.0 + 0.49 - 0.1 * 0.7 * 14.0;
    assert!((surface.value(0, &at) - exact).abs() < 1e-12);
    let slopes = surface.slopes(0, &at);
    assert!((slopes[0] - (1.4 - 1.4)).abs() < 1e-12, "{slopes:?}");
    assert!((slopes[1] + 0.07).abs() < 1e-12, "{slopes:?}");
}

/// Of `1 - exp(-x)` over -1 to 1, runs at three levels give b1 = sinh 1 and b2 = 1 - cosh 1 and take the cube for x, so that c moves
/// the slope in the middle by -c: sd |b2| tanh(1/2) = 0.251, and the slope is in truth off by sinh 1 - 1 = 0.175. A parabola with
/// b1 = 4 and b2 = 1 may hide 1/4.
#[test]
fn a_steep_bend_may_hide_a_cube() {
    let at = |x: f64, y: f64| Sample {
        place: 0,
        factor: 1.0,
        at: vec![1.0 + x, 20.0],
        values: BTreeMap::from([("y".to_owned(), y)]),
        regime: String::new(),
        key: format!("{x}"),
    };
    let hidden = |shows: fn(f64) -> f64| {
        let samples = [-1.0, 0.0, 1.0, -1.0, 0.0, 1.0].map(|x| at(x, shows(x)));
        let all: Vec<_> = samples.iter().collect();
        let axes = (0, &[0][..], &[][..]);
        let names = ["y".to_owned()];
        let surface = Surface::fit(axes, &names, &region(), &all, Degree::Quadratic).unwrap();
        surface.hidden_slopes(0, &[1.0, 20.0])[0].sqrt()
    };
    let of_exponential = (1.0_f64.cosh() - 1.0) * 0.5_f64.tanh();
    assert!((hidden(|x| 1.0 - (-x).exp()) - of_exponential).abs() < 1e-9);
    assert!((hidden(|x| 4.0 * x + x * x) - 0.25).abs() < 1e-9);
    assert!(hidden(|x| 4.0 * x) < 1e-9);
}

/// With n fresh runs at a point the surface goes through their mean, with the variance of that mean.
#[test]
fn an_anchored_surface_goes_through_the_fresh_runs() {
    let shift = 3.0 - (1.0 + 0.25 - 0.1 * 0.5 * 20.0);
    let fresh = [0.1, -0.1, 0.2, -0.2].map(|noise| sample(0.5, 20.0, shift + noise));
    let surface = fitted(&grid()).anchored(&fresh.iter().collect::<Vec<_>>());
    assert!((surface.value(0, &[0.5, 20.0]) - 3.0).abs() < 1e-12);
    assert!((surface.leverage(&[0.5, 20.0]) - 0.25).abs() < 1e-12);
    assert!(
        surface.leverage(&[1.5, 20.0]) > 0.25,
        "it knows less elsewhere"
    );
}

/// Three runs do not fix the six terms of a quadratic in two parameters, nor leave a degree of freedom for a plane:
/// what is left is a mean; one run leaves nothing.
#[test]
fn too_few_runs_give_a_lower_degree_and_one_run_gives_nothing() {
    let samples = grid();
    let names = ["y".to_owned()];
    let some: Vec<_> = samples[..3].iter().collect();
    let make = |some: &[&Sample]| {
        Surface::fit(
            (0, &[0, 1], &[]),
            &names,
            &region(),
            some,
            Degree::Quadratic,
        )
    };
    assert_eq!(make(&some).unwrap().degree, Degree::Constant);
    assert!(make(&some[..1]).is_none());
    let more: Vec<_> = samples[..6].iter().collect();
    assert_eq!(make(&more).unwrap().degree, Degree::Linear);
}

/// Nine runs of noise +-1 in a pattern that no quadratic can follow: the residual variance is known by hand.
#[test]
fn the_scatter_of_repeats_is_pooled() {
    let surface = fitted(&grid());
    let repeats = [sample(1.0, 20.0, 0.5), sample(1.0, 20.0, -0.5)];
    let groups = [repeats.iter().collect::<Vec<_>>()];
    let pooled = surface.with_scatter(&groups);
    // Exact surface with 3 degrees of freedom; two repeats with a sum of squares of 0.5.
    assert!((pooled.degrees_of_freedom - 4.0).abs() < 1e-12);
    assert!((pooled.covariance[(0, 0)] - 0.125).abs() < 1e-12);
    // Runs that are known tell nothing new, neither repeats nor those of the design.
    assert_eq!(pooled.with_scatter(&groups), pooled);
    let of_design: Vec<Sample> = grid();
    assert_eq!(surface.with_scatter(&[of_design.iter().collect()]), surface);
}
