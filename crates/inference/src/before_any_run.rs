//! What is known before any run: measurements that cannot fix their parameters.

use crate::{CalibrationProblem, Role};
use std::collections::BTreeSet;

impl CalibrationProblem {
    /// Why no result of this problem can count as met; none if one can.
    ///
    /// # Method
    ///
    /// Each parameter needs a row of its own that depends on it: a measured value of role fit, or its prior. A maximum matching
    /// of parameters and rows finds whether there are enough, and which parameters share too few (Hall's theorem).
    pub fn cannot_be_met(&self) -> Option<String> {
        let rows = self.rows();
        let mut owner: Vec<Option<usize>> = vec![None; rows.len()];
        for j in 0..self.parameters.len() {
            let mut reached = BTreeSet::new();
            if !assign(j, &rows, &mut owner, &mut reached) {
                // The rows reached belong to parameters that share them with j.
                let sharing = reached.iter().filter_map(|&row| owner[row]).chain([j]);
                let sharing: BTreeSet<usize> = sharing.collect();
                return Some(self.too_few(&sharing, reached.len()));
            }
        }
        None
    }

    /// The parameters on which each measured value of role fit and each prior depends.
    fn rows(&self) -> Vec<Vec<usize>> {
        let fitted = self.measurements.iter().filter(|m| m.role == Role::Fit);
        let fitted = fitted.map(|m| self.models[m.model].parameters.clone());
        let priors = self.parameters.iter().enumerate();
        let priors = priors.filter(|(_, p)| p.prior.is_some());
        fitted.chain(priors.map(|(j, _)| vec![j])).collect()
    }

    /// The sentence about parameters with fewer rows than their number.
    fn too_few(&self, sharing: &BTreeSet<usize>, rows: usize) -> String {
        let symbols: Vec<&str> = sharing
            .iter()
            .map(|&j| self.parameters[j].symbol.as_str())
            .collect();
        let values = if rows == 1 {
            "value depends"
        } else {
            "values depend"
        };
        format!(
            "{rows} fitted {values} on {}, fewer than these {} parameters: they cannot be fixed; measure more, or tune fewer",
            symbols.join(" and "),
            symbols.len()
        )
    }
}

/// Gives parameter j a row of its own, moving others to further rows if need be.
fn assign(
    j: usize,
    rows: &[Vec<usize>],
    owner: &mut [Option<usize>],
    reached: &mut BTreeSet<usize>,
) -> bool {
    for row in 0..rows.len() {
        if !rows[row].contains(&j) || !reached.insert(row) {
            continue;
        }
        let is_free = match owner[row] {
            None => true,
            Some(other) => assign(other, rows, owner, reached),
        };
        if is_free {
            owner[row] = Some(j);
            return true;
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use crate::{CalibrationProblem, Measurement, Model, Parameter, Prior, Role};
    use std::collections::BTreeMap;

    /// A problem of models that depend on these parameters, with one value each.
    fn problem(parameters: usize, models: &[(&[usize], Role)]) -> CalibrationProblem {
        let parameter = |j: usize| Parameter::new(&format!("P{j}"), [0.0, 1.0]);
        let model = |(k, (on, _)): (usize, &(&[usize], Role))| Model {
            name: k.to_string(),
            scene: k.to_string(),
            condition: BTreeMap::new(),
            parameters: on.to_vec(),
        };
        let measured = |(model, (_, role)): (usize, &(&[usize], Role))| Measurement {
            model,
            observable: "y".into(),
            role: *role,
            mean: 0.0,
            sd: 1.0,
            n: 5.0,
            is_scatter: false,
        };
        CalibrationProblem {
            id: "p".into(),
            parameters: (0..parameters).map(parameter).collect(),
            models: models.iter().enumerate().map(model).collect(),
            measurements: models.iter().enumerate().map(measured).collect(),
            ..CalibrationProblem::default()
        }
    }

    /// Two parameters and one fitted value; the check counts for nothing. A prior is a row of its own.
    #[test]
    fn fewer_values_than_parameters_cannot_fix_them() {
        let mut one = problem(2, &[(&[0, 1], Role::Fit), (&[0, 1], Role::Check)]);
        let why = one.cannot_be_met().unwrap();
        assert!(
            why.starts_with("1 fitted value depends on P0 and P1"),
            "{why}"
        );
        one.parameters[1].prior = Some(Prior { mean: 0.5, sd: 0.1 });
        assert_eq!(one.cannot_be_met(), None);
    }

    /// Four values for three parameters, but three of them see P0 alone: P1 and P2 share one.
    #[test]
    fn many_values_of_one_parameter_do_not_fix_two_others() {
        let rows: [(&[usize], Role); 4] = [
            (&[0], Role::Fit),
            (&[0], Role::Fit),
            (&[1, 2], Role::Fit),
            (&[0], Role::Fit),
        ];
        let why = problem(3, &rows).cannot_be_met().unwrap();
        assert!(
            why.starts_with("1 fitted value depends on P1 and P2"),
            "{why}"
        );
    }

    /// P0 first takes the row that P1 needs, and is moved to its other one.
    #[test]
    fn a_parameter_moves_to_another_value_to_make_room() {
        let rows: [(&[usize], Role); 3] = [
            (&[0, 1], Role::Fit),
            (&[0], Role::Fit),
            (&[0, 1], Role::Check),
        ];
        assert_eq!(problem(2, &rows).cannot_be_met(), None);
    }
}
