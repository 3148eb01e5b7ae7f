use super::{PowerDesign, power};
use crate::diagnosis::problem_file::{Condition, Level};

/// Speeds with so many observables at each, and so many effects; two parameters; exact simulated means.
fn design(speeds: usize, observables: usize, effects: usize) -> PowerDesign {
    let condition = |k: usize| Condition::from([("rpm".to_owned(), Level::Number(5.0 + k as f64))]);
    let rows: Vec<[usize; 2]> = (0..speeds)
        .flat_map(|c| (0..observables).map(move |k| [c, k]))
        .collect();
    PowerDesign {
        conditions: (0..speeds).map(condition).collect(),
        simulated_variance: vec![0.0; rows.len()],
        rows,
        declared: vec![vec![true; speeds]; 2],
        effects: vec![vec![true; speeds]; effects],
    }
}

/// An effect that no value shows is never seen: as many values as parameters, or no effect.
#[test]
fn a_design_without_degrees_of_freedom_sees_nothing() {
    for design in [design(2, 1, 3), design(5, 1, 0)] {
        let [row] = power(&design, &[12.0], 20, 1).unwrap()[..] else {
            panic!("one size");
        };
        assert_eq!(row.unseen, 1.0);
    }
}

/// A lone effect of twelve standard errors, exactly known, is found in all but a few of 100 campaigns: its score is above
/// the gate by nine standard deviations, and only an unknown effect can stand in its way, in some 10 of 100, or by
/// chance a rest that is not noise, in 3: of the 87 that are found 80 or fewer come with a chance of 3 %. One of a hundredth of a
/// standard error is nothing: the gates open by chance in 5 of 100, more than 13 with a chance of 0.0005.
#[test]
fn a_large_effect_is_found_and_none_is_not() {
    let rows = power(&design(8, 2, 1), &[0.01, 12.0], 100, 1).unwrap();
    assert!(rows[0].unseen >= 0.87, "{rows:?}");
    assert!(rows[1].named + rows[1].tied >= 0.8, "{rows:?}");
    for row in rows {
        let sum = row.named + row.tied + row.wrong + row.unknown + row.unseen;
        assert!((sum - 1.0).abs() < 1e-12, "{row:?}");
    }
}

/// Seven degrees of freedom and twenty effects can see, but not name: in fewer than a quarter of 100 campaigns at six
/// standard errors (a campaign by the solver had 8 %), and three effects on the same values are named in more. Four more
/// observables raise it: by more than twice the standard error of the difference, 0.12.
#[test]
fn seven_degrees_of_freedom_cannot_name_one_of_twenty() {
    let named = |design: &PowerDesign| power(design, &[6.0], 100, 2).unwrap()[0];
    let few = named(&design(9, 1, 20));
    assert!(few.named < 0.25, "{few:?}");
    assert!(few.unseen < 0.5, "{few:?}");
    let small_library = named(&design(9, 1, 3));
    assert!(small_library.named > few.named, "{small_library:?}");
    let mut wide = design(9, 1, 20);
    for _ in 0..4 {
        wide = wide.with_observable();
    }
    let wide = named(&wide);
    assert!(wide.named > few.named + 0.12, "{wide:?} {few:?}");
}

/// One more of each: a condition has the values of the last one beyond the largest level; an observable stands at all
/// conditions; a scene is one value.
#[test]
fn one_more_adds_what_it_says() {
    let design = design(4, 2, 3);
    let more = design.with_condition();
    assert_eq!(more.rows.len(), 10);
    assert_eq!(more.conditions[4]["rpm"], Level::Number(9.0));
    assert_eq!(more.effects[0].len(), 5);
    assert_eq!(design.with_observable().rows.len(), 12);
    let scene = design.with_scene();
    assert_eq!((scene.rows.len(), scene.conditions.len()), (9, 5));
    assert_eq!(scene.rows[8], [4, 2]);
}
