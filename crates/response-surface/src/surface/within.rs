//! The same surface over narrower or wider ranges of the factors.

use experiment_design::Factor;

use crate::fit::wide::Wide;
use crate::fit::{Case, TermRow, tested};
use crate::surface::natural::{natural_terms, rebased};
use crate::{BoxExtremes, DataRegion, Error, Fit, NamedValues};

impl Fit {
    /// Least and greatest value over the ranges of the factors.
    ///
    /// # Errors
    /// [`Error::DegreeTooHigh`].
    pub fn extremes(&self) -> Result<BoxExtremes, Error> {
        Ok(crate::surface::extremes::box_extremes(
            &self.quadratic()?,
            &self.factors,
        ))
    }

    /// The fit with other bounds of its factors: the coded range -1..+1 becomes the new one, and
    /// coefficients and their covariances are carried over exactly. Tests of the terms, cases and
    /// canonical form belong to the old coding and are left empty.
    ///
    /// # Errors
    /// [`Error::FactorMismatch`] for factors with other symbols.
    pub fn within(&self, factors: &[Factor]) -> Result<Self, Error> {
        let symbols = |list: &[Factor]| -> Vec<String> {
            list.iter().map(|f| f.symbol().to_owned()).collect()
        };
        if symbols(factors) != symbols(&self.factors) {
            return Err(Error::FactorMismatch {
                model: symbols(&self.factors).join(", "),
                given: symbols(factors).join(", "),
            });
        }
        // The new coded value x' gives the old one as offset + slope x'.
        let lines: Vec<(f64, f64)> = self
            .factors
            .iter()
            .zip(factors)
            .map(|(old, new)| (old.coded(new.mid()), new.half_range() / old.half_range()))
            .collect();
        Ok(self.remapped(factors.to_vec(), &lines, &[]))
    }

    /// The fit over fewer factors: those at the given places (from 0) are held at coded values.
    ///
    /// # Errors
    /// [`Error::SettingOutOfRange`] for a value that is not finite; [`Error::Length`] for a place without
    /// factor, or if no factor is left.
    pub fn held(&self, held: &[(usize, f64)]) -> Result<Self, Error> {
        let k = self.factors.len();
        let mut lines = vec![(0.0, 1.0); k];
        for &(j, value) in held {
            if !value.is_finite() {
                return Err(Error::SettingOutOfRange {
                    what: "the value of a held factor",
                    value,
                    range: "a finite number",
                });
            }
            let line = lines.get_mut(j).ok_or(Error::Length {
                what: "factors",
                expected: j + 1,
                given: k,
            })?;
            *line = (value, 0.0);
        }
        let dropped: Vec<usize> = (0..k).filter(|&j| lines[j].1 == 0.0).collect();
        let left = (0..k).filter(|j| !dropped.contains(j));
        let factors: Vec<Factor> = left.map(|j| self.factors[j].clone()).collect();
        if factors.is_empty() {
            return Err(Error::Length {
                what: "factors that are not held",
                expected: 1,
                given: 0,
            });
        }
        Ok(self.remapped(factors, &lines, &dropped))
    }

    /// The fit of a surface that is raised by a constant, as runs elsewhere ask for: its sums of squares and tests stay those of its runs,
    /// the intercept has no test any more.
    #[must_use]
    pub fn raised(mut self, by: f64) -> Self {
        let raised = |terms: NamedValues<TermRow>| -> NamedValues<TermRow> {
            let row = |(name, row): (&str, &TermRow)| {
                let intercept = || tested(row.coef + by, 0.0, None, 0);
                let row = if name == "1" {
                    intercept()
                } else {
                    row.clone()
                };
                (name.to_owned(), row)
            };
            terms.iter().map(row).collect()
        };
        self.terms = raised(self.terms);
        self.terms_natural = raised(self.terms_natural);
        let natural = self.terms_natural.iter();
        self.coef_natural_units = natural.map(|(name, r)| (name.to_owned(), r.coef)).collect();
        if let Some(canonical) = &mut self.canonical {
            canonical.value = canonical.value.map(|value| value + by);
        }
        if let Some(ends) = &mut self.box_extremes {
            ends.min.value += by;
            ends.max.value += by;
        }
        self
    }

    /// What the data span in the factors that are left when some places are dropped.
    fn region_without(&self, dropped: &[usize]) -> Option<DataRegion> {
        if dropped.is_empty() || self.cases.is_empty() {
            return Some(self.data_region.as_ref()?.without(dropped));
        }
        let left = |case: &Case| -> Vec<f64> {
            let natural = self.natural(&case.coded).into_iter().enumerate();
            let kept = natural.filter(|(j, _)| !dropped.contains(j));
            kept.map(|(_, value)| value).collect()
        };
        DataRegion::of(&self.cases.iter().map(left).collect::<Vec<_>>())
    }

    /// The same surface in other coordinates: the old coded value is offset + slope x'. Dropped
    /// coordinates have slope 0.
    fn remapped(&self, factors: Vec<Factor>, lines: &[(f64, f64)], dropped: &[usize]) -> Self {
        let blocks = self.p - self.formula.terms().len();
        let place = |i: usize| if i == 0 { 0 } else { i + blocks };
        let old: Vec<usize> = (0..self.formula.terms().len()).map(place).collect();
        let covariance: Vec<Vec<f64>> = old
            .iter()
            .map(|&i| old.iter().map(|&j| self.xtx_inverse[i][j]).collect())
            .collect();
        let (formula, coefficients, covariance) =
            rebased(&self.formula, lines, &self.coefficients(), &covariance);
        let formula = formula.without(dropped);
        let (mse, df) = (self.mse, self.df_resid);
        let wide: Vec<Wide> = coefficients.iter().map(|&c| Wide::from(c)).collect();
        let terms_natural = natural_terms(&factors, &formula, &wide, &covariance, mse, df);
        let natural = terms_natural.iter();
        let row = |(i, c): (usize, f64)| {
            let row = tested(c, covariance[i][i], self.mse, self.df_resid);
            (formula.name(&formula.terms()[i]), row)
        };
        Self {
            factors,
            terms: coefficients.into_iter().enumerate().map(row).collect(),
            p: formula.terms().len(),
            formula,
            coef_natural_units: natural.map(|(name, r)| (name.to_owned(), r.coef)).collect(),
            terms_natural,
            xtx_inverse: covariance,
            cases: Vec::new(),
            data_region: self.region_without(dropped),
            canonical: None,
            box_extremes: None,
            ..self.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Cell, Model, Observations, fit};
    use experiment_design::{Factor, box_behnken};

    /// Values and leverages at natural points do not depend on the coding (rounding: 1e-12).
    #[test]
    fn the_surface_is_the_same_over_other_ranges() {
        let factor = |s, low, high| Factor::new(s, "", "1", low, high).unwrap();
        let factors = [
            factor("A", 0.0, 10.0),
            factor("B", -1.0, 3.0),
            factor("C", 5.0, 6.0),
        ];
        let cells = box_behnken(&factors, 3)
            .unwrap()
            .coded_rows()
            .into_iter()
            .enumerate();
        let cells =
            cells.map(|(i, x)| Cell::single(x.clone(), x[0] - x[1] * x[2] + (i % 3) as f64));
        let data = Observations::from_cells(cells.collect()).unwrap();
        let old = fit(
            &factors,
            &Model::parse("A + B:C + C^2", &factors).unwrap(),
            &data,
        )
        .unwrap();
        let narrow = [
            factor("A", 2.0, 3.0),
            factor("B", 0.0, 1.0),
            factor("C", 5.5, 7.0),
        ];
        let new = old.within(&narrow).unwrap();
        for point in [[2.0, 0.3, 5.5], [9.0, -1.0, 6.0], [2.5, 0.5, 5.8]] {
            let (a, b) = (old.predict(&point).unwrap(), new.predict(&point).unwrap());
            assert!((a.mean - b.mean).abs() < 1e-12 && (a.leverage - b.leverage).abs() < 1e-12);
        }
        // Bounds are a question, the data are what is known: 9 is beyond the new bounds of A, and 11 beyond the data.
        assert!(!new.predict(&[9.0, 0.5, 5.5]).unwrap().extrapolated);
        assert!(new.predict(&[11.0, 0.5, 5.5]).unwrap().extrapolated);
    }
}
