//! Data and questions at the edge of what a method can answer: an answer that is right, or a refusal that says why.

use experiment_design::Factor;
use response_surface::{
    Cell, Error, Model, Observations, SolutionRequest, Weighting, aliases, fit, fit_weighted,
    solutions, spread,
};

/// Factors whose coded and natural values agree.
fn factors(symbols: &[&str]) -> Vec<Factor> {
    let coded = symbols.iter().map(|s| Factor::coded_only(s));
    coded.collect::<Result<_, _>>().expect("symbols")
}

/// Single runs at coded settings.
fn runs(rows: &[(&[f64], f64)]) -> Observations {
    let cells = rows.iter().map(|(x, y)| Cell::single(x.to_vec(), *y));
    Observations::from_cells(cells.collect()).expect("whole rows")
}

/// A grid of three levels of two factors with the values of a function.
fn grid(surface: &dyn Fn(f64, f64) -> f64) -> Observations {
    let levels = [-1.0, 0.0, 1.0];
    let points = levels.iter().flat_map(|x| levels.map(|z| [*x, z]));
    let cells = points.map(|x| Cell::single(x.to_vec(), surface(x[0], x[1])));
    Observations::from_cells(cells.collect()).expect("whole rows")
}

/// Runs of a bench test without chance differ by their rounding alone, 1e-16 of their mean. Against that any model would lack
/// something: no test is made against them, as rows or within a cell, and none warns.
#[test]
fn repeats_that_differ_by_rounding_test_nothing() {
    let f = factors(&["x"]);
    let model = Model::linear(&f).expect("symbols");
    let bent = |x: f64| 0.04 + 0.01 * x + 1e-6 * x * x;
    let levels = [-1.0, -0.5, 0.0, 0.5, 1.0];
    let twice = |x: f64| {
        let moved = bent(x) * (1.0 + 4.0 * f64::EPSILON);
        [Cell::single(vec![x], bent(x)), Cell::single(vec![x], moved)]
    };
    let rows = Observations::from_cells(levels.into_iter().flat_map(twice).collect());
    let within = |x: f64| Cell {
        sd: Some(1e-17),
        n: 3,
        ..Cell::single(vec![x], bent(x))
    };
    let cells = Observations::from_cells(levels.into_iter().map(within).collect());
    for data in [rows, cells].map(|data| data.expect("whole rows")) {
        let fitted = fit(&f, &model, &data).expect("more rows than terms");
        let of_rows = fitted.lack_of_fit.as_ref().and_then(|l| l.p);
        let replicates = fitted.replicates.as_ref();
        let of_cells = replicates.and_then(|r| r.lack_of_fit_vs_replicates.as_ref()?.p);
        assert_eq!((of_rows, of_cells), (None, None));
        let warned = format!("{:?}", fitted.warnings);
        assert!(!warned.contains("LackOfFit"), "{warned}");
    }
}

/// Two runs lie equally far from their median: their distances do not scatter, F would be 0/0 or, with rounding, any
/// large number. Bartlett's test stands. Larger groups keep their test, and pairs beside them change nothing in it.
#[test]
fn levenes_test_is_not_made_with_pairs() {
    let pair = |x: f64, y: [f64; 2]| y.map(|y| (x, y));
    let pairs = [
        pair(-1.0, [3.1, 3.4]),
        pair(0.0, [2.7, 5.9]),
        pair(1.0, [1.13, 4.2]),
    ]
    .concat();
    let data = |rows: &[(f64, f64)]| {
        let cells = rows.iter().map(|(x, y)| Cell::single(vec![*x], *y));
        Observations::from_cells(cells.collect()).expect("whole rows")
    };
    let tested = spread(&data(&pairs)).expect("repeated settings");
    assert_eq!((tested.groups, tested.levene_groups), (3, 0));
    assert!(tested.levene.is_none() && tested.bartlett.is_some());
    let larger = [2.0, 2.5, 4.0, 7.0].map(|y| (2.0, y));
    let other = [1.0, 1.2, 1.9].map(|y| (3.0, y));
    let alone = spread(&data(&[&larger[..], &other].concat())).expect("repeated settings");
    let beside = spread(&data(&[&pairs[..], &larger, &other].concat())).expect("repeated settings");
    assert_eq!(beside.levene_groups, 2);
    assert!(alone.levene.is_some());
    assert_eq!(alone.levene, beside.levene);
}

/// x^2 + z^2 = 0 is met at one point, the bottom; x^2 = 0 along a valley, nearest to (0.4, 0.3) at (0, 0.3); x + z = 2 at a
/// corner. The bottom is known to the rounding of the values, and the place to its root, 1e-6.
#[test]
fn a_target_that_the_surface_only_touches_has_its_point() {
    let f = factors(&["x", "z"]);
    let quadratic = Model::quadratic(&f).expect("symbols");
    let near = |x: f64| {
        let value = response_surface::Measured {
            value: x,
            sd: None,
            n: None,
        };
        Some(value)
    };
    let answer = |surface: &dyn Fn(f64, f64) -> f64, target: f64| {
        let fitted = fit(&f, &quadratic, &grid(surface)).expect("nine runs");
        let request = SolutionRequest {
            near: vec![near(0.4), near(0.3)],
            ..SolutionRequest::for_target(target)
        };
        solutions(&fitted, &request).expect("degree two")
    };
    for (surface, target, place) in [
        (
            &(|x: f64, z: f64| 36.0 + x * x + z * z) as &dyn Fn(f64, f64) -> f64,
            36.0,
            [0.0, 0.0],
        ),
        (&|x, _| 5.0 + x * x, 5.0, [0.0, 0.3]),
        (&|x, z| x + z, 2.0, [1.0, 1.0]),
        (
            &|x, z| 1.7 - x * x - 3.0 * (z - 0.1) * (z - 0.1),
            1.7,
            [0.0, 0.1],
        ),
    ] {
        let found = answer(surface, target);
        assert!(
            found.exists && found.tangent,
            "{target}: {:?}",
            found.reachable
        );
        let nearest = &found.nearest.get("coded").expect("a nearest point").coded;
        for (x, expected) in nearest.iter().zip(place) {
            assert!((x - expected).abs() < 1e-6, "{target}: {nearest:?}");
        }
        let range = found.factor_ranges.as_ref().and_then(|r| r.get("x"));
        let range = range.expect("a range").coded;
        assert!((range.low - place[0]).abs() < 1e-6, "{range:?}");
    }
    let beyond = answer(&|x, z| 36.0 + x * x + z * z, 36.0 - 1e-9);
    assert!(!beyond.exists && !beyond.tangent);
    let crossed = answer(&|x, z| 36.0 + x * x + z * z, 36.5);
    assert!(crossed.exists && !crossed.tangent);
}

/// A quadratic fitted to a plane has curvatures of rounding only, 1e-60. The foot of (0.4, 0.3) on x + z = 1 is (0.55, 0.45).
#[test]
fn the_nearest_solution_of_a_plane_is_its_foot() {
    let f = factors(&["x", "z"]);
    let quadratic = Model::quadratic(&f).expect("symbols");
    let fitted = fit(&f, &quadratic, &grid(&|x, z| x + z)).expect("nine runs");
    let near = |value| {
        Some(response_surface::Measured {
            value,
            sd: None,
            n: None,
        })
    };
    let request = SolutionRequest {
        near: vec![near(0.4), near(0.3)],
        ..SolutionRequest::for_target(1.0)
    };
    let found = solutions(&fitted, &request).expect("degree two");
    let nearest = found.nearest.get("coded").expect("a nearest point");
    for (x, expected) in nearest.coded.iter().zip([0.55, 0.45]) {
        assert!((x - expected).abs() < 1e-12, "{nearest:?}");
    }
}

/// In the half fraction D = ABC every two-factor interaction is aliased with another (AB with CD) and each main effect for
/// a product of three: coefficients of 1 in the alias matrix, exact but for rounding. A full factorial has none but the
/// squares, which are constant over two levels.
#[test]
fn a_fraction_tells_what_stands_behind_its_terms() {
    let signs = |bits: usize, j: usize| if bits >> j & 1 == 1 { 1.0 } else { -1.0 };
    let f = factors(&["A", "B", "C", "D"]);
    let cells = (0..8).map(|bits| {
        let [a, b, c] = [0, 1, 2].map(|j| signs(bits, j));
        Cell::single(vec![a, b, c, a * b * c], a + 0.5 * b)
    });
    let data = Observations::from_cells(cells.collect()).expect("whole rows");
    let model = Model::parse("A + B + C + D + A:B", &f).expect("a formula");
    let fitted = fit(&f, &model, &data).expect("eight runs");
    let told = aliases(&fitted, &data).expect("the same data");
    let one = |left_out: &str, term: &str| {
        let parts = told.get(left_out).expect(left_out);
        assert_eq!(parts.names().collect::<Vec<_>>(), [term], "{left_out}");
        assert!((parts.get(term).expect(term) - 1.0).abs() < 1e-12);
    };
    one("CD", "AB");
    one("ABC", "D");
    one("BCD", "A");
    one("A2", "1");
    assert!(told.get("AC").is_none(), "it is orthogonal to all terms");
    let cells =
        (0..16).map(|bits| Cell::single([0, 1, 2, 3].map(|j| signs(bits, j)).to_vec(), 1.0));
    let full = Observations::from_cells(cells.collect()).expect("whole rows");
    let fitted = fit(&f, &model, &full).expect("sixteen runs");
    let told = aliases(&fitted, &full).expect("the same data");
    assert!(told.names().all(|name| name.ends_with('2')), "{told:?}");
}

/// Two models of one polynomial: without intercept the weighted row enters with its weight. y = 2 x + b with b = 0.3 left
/// out: coefficient of the intercept on x is sum w x / sum w x^2.
#[test]
fn the_alias_matrix_holds_the_weights() {
    let f = factors(&["x"]);
    let cell = |x: f64, n: usize| Cell {
        n,
        ..Cell::single(vec![x], 2.0 * x + 0.3)
    };
    let data = Observations::from_cells(vec![cell(0.5, 1), cell(1.0, 3), cell(-0.2, 2)]);
    let data = data.expect("whole rows");
    let model = Model::parse("0 + x", &f).expect("a formula");
    let fitted = fit_weighted(&f, &model, &data, Weighting::Counts).expect("three rows");
    let told = aliases(&fitted, &data).expect("the same data");
    let expected = (0.5 + 3.0 - 0.4) / (0.25 + 3.0 + 0.08);
    let got = told.get("1").and_then(|parts| parts.get("x"));
    assert!((got.expect("a bias") - expected).abs() < 1e-13);
    let slope = fitted.terms.get("x").expect("a slope").coef;
    assert!((slope - (2.0 + 0.3 * expected)).abs() < 1e-13, "{slope}");
}

#[test]
fn blocks_bear_their_names() {
    let f = factors(&["x"]);
    let cell = |x: f64, block: usize| Cell {
        block,
        ..Cell::single(vec![x], x + block as f64)
    };
    let cells = [(-1.0, 1), (1.0, 1), (-1.0, 2), (1.0, 2)].map(|(x, block)| cell(x, block));
    let data = Observations::from_cells(cells.to_vec()).expect("whole rows");
    let named = data.with_block_names(vec!["north".to_owned(), "south".to_owned()]);
    let fitted = fit(&f, &Model::linear(&f).expect("symbols"), &named).expect("four runs");
    let north = fitted.terms.get("block north").expect("named").coef;
    assert!((north + 0.5).abs() < 1e-14, "{north}");
}

/// A factor in a unit that makes its range 1e-100: its square has a coefficient of 1e200 and a variance beyond all numbers.
#[test]
fn a_range_whose_powers_are_no_numbers_is_refused() {
    let data = runs(&[(&[-1.0], 1.0), (&[0.0], 2.0), (&[1.0], 4.0), (&[0.5], 3.0)]);
    for (low, high) in [(1e-100, 2e-100), (1e150, 2e150), (1.0, 1.0 + 1e-15)] {
        let tiny = Factor::new("x", "", "1", low, high).expect("a range");
        let f = std::slice::from_ref(&tiny);
        let model = Model::parse("x + x^10", f).expect("a formula");
        let refused = fit(f, &model, &data);
        assert!(
            matches!(refused, Err(Error::FactorScale { .. })),
            "{low}: {refused:?}"
        );
    }
    let tiny = Factor::new("x", "", "1", 1e-30, 2e-30).expect("a range");
    let f = std::slice::from_ref(&tiny);
    let fitted = fit(f, &Model::quadratic(f).expect("symbols"), &data).expect("four runs");
    let finite = |row: &response_surface::fit::TermRow| row.se.is_some_and(f64::is_finite);
    assert!(fitted.terms_natural.values().all(finite));
    let far = runs(&[(&[1e200], 1.0), (&[1.0], 2.0), (&[0.0], 2.0)]);
    let f = factors(&["x"]);
    let refused = fit(&f, &Model::linear(&f).expect("symbols"), &far);
    assert!(matches!(refused, Err(Error::BadObservation { row: 1, .. })));
}
