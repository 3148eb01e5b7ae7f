//! Correlations between measured means: the blocks that they make, and what is invalid.

use crate::{CalibrationProblem, Correlation};
use nalgebra::{Cholesky, DMatrix};

/// Correlation of two measurements of a problem by their numbers; 1 of a measurement with itself, 0 if none is stated.
pub(crate) fn correlation_of(problem: &CalibrationProblem, a: usize, b: usize) -> f64 {
    let joins = |c: &&Correlation| (c.a, c.b) == (a, b) || (c.b, c.a) == (a, b);
    let stated = problem.correlations.iter().find(joins);
    stated.map_or(f64::from(u8::from(a == b)), |c| c.value)
}

/// Tells every correlation that is invalid, and every group of measurements whose correlations contradict each other.
pub(crate) fn check_correlations(problem: &CalibrationProblem, wrong: &mut Vec<String>) {
    let before = wrong.len();
    for (k, c) in problem.correlations.iter().enumerate() {
        let n = problem.measurements.len();
        if c.a >= n || c.b >= n {
            wrong.push(format!(
                "correlation of the measurements {} and {}: there are {n} measurements",
                c.a, c.b
            ));
            continue;
        }
        let (a, b) = (&problem.measurements[c.a], &problem.measurements[c.b]);
        let names = format!(
            "correlation of {} and {}",
            name(problem, c.a),
            name(problem, c.b)
        );
        if c.a == c.b {
            wrong.push(format!("{names}: a measurement goes with itself: name two"));
        } else if (a.model, a.role) != (b.model, b.role) {
            wrong.push(format!(
                "{names}: means of two models or roles come from different frames: leave it out"
            ));
        } else if c.value.is_nan() || c.value.abs() >= 1.0 {
            wrong.push(format!("{names}: {} must lie between -1 and 1", c.value));
        }
        let same = |o: &Correlation| (o.a, o.b) == (c.a, c.b) || (o.b, o.a) == (c.a, c.b);
        if problem.correlations[..k].iter().any(same) {
            wrong.push(format!("{names} is given twice: give it once"));
        }
    }
    if wrong.len() == before {
        check_blocks(problem, wrong);
    }
}

/// Lists the models and roles whose correlations cannot be those of means.
fn check_blocks(problem: &CalibrationProblem, wrong: &mut Vec<String>) {
    let mut seen = Vec::new();
    for c in &problem.correlations {
        let m = &problem.measurements[c.a];
        if seen.contains(&(m.model, m.role)) {
            continue;
        }
        seen.push((m.model, m.role));
        let of_block = |k: &usize| {
            let other = &problem.measurements[*k];
            let joined = problem.correlations.iter().any(|c| c.a == *k || c.b == *k);
            (other.model, other.role) == (m.model, m.role) && joined
        };
        let block: Vec<usize> = (0..problem.measurements.len()).filter(of_block).collect();
        let matrix = DMatrix::from_fn(block.len(), block.len(), |i, j| {
            correlation_of(problem, block[i], block[j])
        });
        if Cholesky::new(matrix).is_none() {
            let names: Vec<String> = block.iter().map(|k| name(problem, *k)).collect();
            wrong.push(format!(
                "correlations of {}: they contradict each other (the matrix is not positive definite): state smaller ones, or \
                 leave out an observable that the others give",
                names.join(", ")
            ));
        }
    }
}

/// A measurement in words.
fn name(problem: &CalibrationProblem, k: usize) -> String {
    let m = &problem.measurements[k];
    format!("{} of {}", m.observable, problem.models[m.model].name)
}

#[cfg(test)]
mod tests {
    use crate::diagnosis_stage::plan;
    use crate::{
        CalibrationProblem, Correlation, Error, LoopSettings, Measurement, Model, Parameter, Role,
    };
    use std::collections::BTreeMap;

    /// Three observables of one drum and one of another, sd of the means 0.1, 0.2, 0.3 and 0.4.
    fn problem(correlations: &[(usize, usize, f64)]) -> CalibrationProblem {
        let measured = |model, observable: &str, sd| Measurement {
            model,
            observable: observable.into(),
            role: Role::Fit,
            mean: 1.0,
            sd,
            n: 1.0,
            is_scatter: false,
        };
        let model = |name: &str| Model {
            name: name.into(),
            scene: "drum".into(),
            condition: BTreeMap::new(),
            parameters: vec![0],
        };
        CalibrationProblem {
            id: "correlated".into(),
            parameters: vec![Parameter::new("F", [0.0, 1.0])],
            models: vec![model("slow"), model("fast")],
            measurements: vec![
                measured(0, "angle", 0.1),
                measured(0, "curvature", 0.2),
                measured(0, "s_shape", 0.3),
                measured(1, "angle", 0.4),
            ],
            correlations: correlations
                .iter()
                .map(|&(a, b, value)| Correlation { a, b, value })
                .collect(),
            ..CalibrationProblem::default()
        }
    }

    /// The line of the only problem.
    fn refused(correlations: &[(usize, usize, f64)]) -> String {
        match problem(correlations).check() {
            Err(Error::Problem { lines }) => lines.join("; "),
            other => panic!("{other:?}"),
        }
    }

    /// Correlation times the standard deviations of the two means, 0.5 * 0.1 * 0.2, on both sides of the diagonal; nothing
    /// elsewhere.
    #[test]
    fn a_correlation_stands_beside_the_diagonal_of_the_plan() {
        let problem = problem(&[(1, 0, 0.5)]);
        problem.check().unwrap();
        let plan = plan(&problem, &LoopSettings::default(), &[0.5]);
        assert_eq!(plan.observables, ["angle", "curvature", "s_shape"]);
        let [slow, fast] = [0, 1].map(|c| &plan.conditions[c].covariance);
        for (i, row) in slow.iter().enumerate() {
            for (j, value) in row.iter().enumerate() {
                let expected = match (i, j) {
                    (0, 0 | 1) | (1, 0) => 0.01,
                    (1, 1) => 0.04,
                    (2, 2) => 0.09,
                    _ => 0.0,
                };
                assert!((value - expected).abs() < 1e-15, "{i} {j}: {value}");
            }
        }
        assert!(
            (fast[0][0] - 0.16).abs() < 1e-15 && fast[0][1] == 0.0,
            "{fast:?}"
        );
    }

    /// 0.9, 0.9 and -0.9 between three: no three means go together so.
    #[test]
    fn what_cannot_be_meant_is_told_by_name() {
        let contrary = refused(&[(0, 1, 0.9), (1, 2, 0.9), (0, 2, -0.9)]);
        for word in [
            "angle of slow",
            "curvature of slow",
            "s_shape of slow",
            "positive definite",
        ] {
            assert!(contrary.contains(word), "{contrary}");
        }
        problem(&[(0, 1, 0.9), (1, 2, 0.9), (0, 2, 0.9)])
            .check()
            .unwrap();
        for (value, words) in [(1.0, "between -1 and 1"), (f64::NAN, "between -1 and 1")] {
            let told = refused(&[(0, 1, value)]);
            assert!(
                told.contains(words) && told.contains("angle of slow"),
                "{told}"
            );
        }
        assert!(refused(&[(0, 3, 0.2)]).contains("two models or roles"));
        assert!(refused(&[(0, 0, 0.2)]).contains("itself"));
        assert!(refused(&[(0, 9, 0.2)]).contains("there are 4"));
        assert!(refused(&[(0, 1, 0.2), (1, 0, 0.3)]).contains("twice"));
    }

    /// A problem that was written before there were correlations has none.
    #[test]
    fn a_problem_without_correlations_reads_and_writes_as_ever() {
        let text = serde_json::to_string(&problem(&[])).unwrap();
        assert!(!text.contains("correlations"), "{text}");
        let read: CalibrationProblem = serde_json::from_str(&text).unwrap();
        assert_eq!(read, problem(&[]));
    }
}
