//! The small cases with what was measured, ready for readings of the parameters.

use crate::Error;
use crate::advice::LARGEST;
use crate::case::Case;
use crate::convention::{CONVENTIONS, Convention, NOTHING, concerns};
use crate::expected::{Expected, shift};
use crate::model::Model;
use crate::reference;
use crate::small_cases::cases;
use crate::variant::Variant;
use nalgebra::{DMatrix, DVector};

/// Step of the logarithm of a factor for its slope.
pub(crate) const STEP: f64 = 0.02;

/// A combination of conventions with their fitted factors.
#[derive(Debug, Clone)]
pub(crate) struct Fitted {
    /// Indices in [`CONVENTIONS`].
    pub(crate) conventions: Vec<usize>,
    /// Logarithms of the factors; 0 for a switch.
    pub(crate) logs: Vec<f64>,
    /// Residual in bands.
    pub(crate) residual: DVector<f64>,
    /// 95 % intervals of the logarithms; those of the values themselves until they are computed.
    pub(crate) intervals: Vec<[f64; 2]>,
}

impl Fitted {
    pub(crate) fn sum_of_squares(&self) -> f64 {
        self.residual.norm_squared()
    }
}

/// The small cases with what was measured, ready for readings of the parameters.
pub(crate) struct Bench<'a> {
    pub(crate) model: &'a Model,
    /// The reading with the conventions that are accepted.
    pub(crate) base: Variant,
    /// By how much these move the numbers.
    pub(crate) moved: Vec<f64>,
    pub(crate) cases: Vec<Case>,
    pub(crate) nominal: Vec<Vec<f64>>,
    /// Which cases each convention changes.
    pub(crate) affected: Vec<Vec<bool>>,
    /// Got minus expected, in bands.
    pub(crate) residual: DVector<f64>,
    pub(crate) bands: DVector<f64>,
    pub(crate) names: Vec<String>,
}

impl<'a> Bench<'a> {
    pub(crate) fn new(
        model: &'a Model,
        expected: &[Expected],
        got: &[f64],
        accepted: &[String],
    ) -> Result<Self, Error> {
        let cases = cases(model);
        let names: Vec<String> = cases
            .iter()
            .flat_map(|case| {
                case.quantities
                    .iter()
                    .map(|q| format!("{} {}", case.name, q.name()))
            })
            .collect();
        let small: Vec<(&Expected, f64)> = expected
            .iter()
            .zip(got.iter().copied())
            .filter(|(row, _)| !row.varies)
            .collect();
        let stored: Vec<String> = small
            .iter()
            .map(|(row, _)| format!("{} {}", row.case, row.quantity))
            .collect();
        if stored != names || expected.len() != got.len() {
            return Err(Error::OtherVersion);
        }
        let base = with_accepted(model, accepted)?;
        let nominal: Vec<Vec<f64>> = cases
            .iter()
            .map(|case| reference::run(case, &base))
            .collect();
        let own = Variant::nominal(model);
        let moved = cases
            .iter()
            .zip(&nominal)
            .flat_map(|(case, nominal)| shift(case, nominal, &own));
        let moved: Vec<f64> = moved.map(|by| -by).collect();
        let affected = CONVENTIONS
            .iter()
            .map(|convention| affected(convention, &base, &cases, &nominal));
        let bands = DVector::from_iterator(small.len(), small.iter().map(|(row, _)| row.band));
        let residual = small
            .iter()
            .zip(&moved)
            .map(|((row, got), moved)| (got - row.value - moved) / row.band);
        let residual: Vec<f64> = residual.collect();
        Ok(Self {
            residual: DVector::from_vec(residual),
            affected: affected.collect(),
            base,
            moved,
            model,
            cases,
            nominal,
            bands,
            names,
        })
    }

    /// Change of the numbers, in bands, by conventions read in other ways.
    pub(crate) fn shift(&self, conventions: &[usize], logs: &[f64]) -> DVector<f64> {
        let mut variant = self.base.clone();
        for (convention, log) in conventions.iter().zip(logs) {
            CONVENTIONS[*convention].apply(&mut variant, log.exp());
        }
        let each = (0..self.cases.len()).flat_map(|c| {
            let nominal = &self.nominal[c];
            if conventions.iter().any(|&k| self.affected[k][c]) {
                shift(&self.cases[c], nominal, &variant)
            } else {
                vec![0.0; nominal.len()]
            }
        });
        DVector::from_iterator(self.bands.len(), each).component_div(&self.bands)
    }

    /// Conventions that can matter to the model.
    pub(crate) fn concerned(&self) -> Vec<usize> {
        (0..CONVENTIONS.len())
            .filter(|&k| concerns(&CONVENTIONS[k], self.model))
            .collect()
    }

    /// Slopes of the numbers, in bands, by the logarithms of the free factors.
    pub(crate) fn slopes(
        &self,
        conventions: &[usize],
        logs: &[f64],
        free: &[usize],
    ) -> DMatrix<f64> {
        let here = self.shift(conventions, logs);
        let columns: Vec<DVector<f64>> = free
            .iter()
            .map(|&k| {
                let mut beside = logs.to_vec();
                beside[k] += STEP;
                (self.shift(conventions, &beside) - &here) / STEP
            })
            .collect();
        DMatrix::from_columns(&columns)
    }

    pub(crate) fn at(&self, conventions: &[usize], logs: Vec<f64>) -> Fitted {
        Fitted {
            residual: &self.residual - self.shift(conventions, &logs),
            intervals: logs.iter().map(|&log| [log, log]).collect(),
            conventions: conventions.to_vec(),
            logs,
        }
    }
}

/// The reading of this solver with the conventions that are accepted.
fn with_accepted(model: &Model, accepted: &[String]) -> Result<Variant, Error> {
    let mut base = Variant::nominal(model);
    for name in accepted {
        let found = CONVENTIONS
            .iter()
            .find(|c| c.name == name && !c.is_factor());
        let Some(convention) = found else {
            let known = CONVENTIONS
                .iter()
                .filter(|c| !c.is_factor())
                .map(|c| c.name);
            return Err(Error::Accepted {
                name: name.clone(),
                known: known.collect::<Vec<_>>().join(", "),
            });
        };
        convention.apply(&mut base, 1.0);
    }
    Ok(base)
}

/// Which cases a convention changes, a little or as far as it goes.
fn affected(
    convention: &Convention,
    base: &Variant,
    cases: &[Case],
    nominal: &[Vec<f64>],
) -> Vec<bool> {
    let factors: &[f64] = if convention.is_factor() {
        &[NOTHING, 1.0 + STEP, LARGEST]
    } else {
        &[1.0]
    };
    let changes = |case: &Case, nominal: &[f64]| {
        factors.iter().any(|factor| {
            let mut variant = base.clone();
            convention.apply(&mut variant, *factor);
            shift(case, nominal, &variant).iter().any(|by| *by != 0.0)
        })
    };
    let concerned = concerns(convention, &base.model);
    cases
        .iter()
        .zip(nominal)
        .map(|(case, nominal)| concerned && changes(case, nominal))
        .collect()
}
