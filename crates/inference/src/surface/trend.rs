//! The trend of a surface with the size of the grains.

use super::{SINGULAR, Surface};
use crate::samples::Sample;
use nalgebra::{DMatrix, DVector};

impl Surface {
    /// Whether it knows how its observables change with the size of the grains.
    pub(crate) fn has_trend(&self) -> bool {
        self.coarsest.is_some()
    }

    /// How an observable changes with the size of the grains at a point, per real diameter, and the variance of that over that of a
    /// run; `None` if the runs have one size.
    pub(crate) fn trend(&self, k: usize, at: &[f64]) -> Option<(f64, f64)> {
        let one = self.coarsest?;
        let row = self.slope_of_terms(&self.coded(at, 1.0), self.parameters.len());
        let slope = row.dot(&self.polynomials.coefficients.column(k)) / one;
        Some((slope, self.polynomials.covariance(&row, &row) / (one * one)))
    }

    /// Whether a trend that is straight misses the runs behind the surface: by how much a term in the square of the size would
    /// change the value for real grains at a point, and the chance that noise alone makes so much of it. `None` if the runs have
    /// fewer than three sizes.
    ///
    /// # Formula
    ///
    /// With w the square of the coordinate, `u = w - X (X'X)^-1 X'w` and e the residuals, `c = u'e / u'u` is its coefficient; `c² u'u`
    /// is compared with the residual variance that is left by `F(1, n - p - 1)` `[Myers2016, chapter 2]`. The value at x changes by
    /// `-c x'(X'X)^-1 X'w`.
    pub(crate) fn bend(&self, k: usize, used: &[&Sample], at: &[f64]) -> Option<(f64, f64)> {
        let one = self.coarsest?;
        let n = used.len();
        let rows: Vec<_> = used
            .iter()
            .map(|s| self.terms_at(&s.at, s.factor).transpose())
            .collect();
        let x = DMatrix::from_rows(&rows);
        let w = DVector::from_fn(n, |i, _| ((used[i].factor - 1.0) / one).powi(2));
        let name = &self.observables[k];
        let y = DVector::from_fn(n, |i, _| used[i].values[name]);
        let e = y - &x * self.polynomials.coefficients.column(k);
        let followed = &self.polynomials.inverse * x.tr_mul(&w);
        let u = &w - &x * &followed;
        let dof = n as f64 - x.ncols() as f64 - 1.0;
        if u.norm_squared() <= SINGULAR * SINGULAR * w.norm_squared() || dof <= 0.0 {
            return None;
        }
        let c = u.dot(&e) / u.norm_squared();
        let of_bend = c * c * u.norm_squared();
        let left = (e.norm_squared() - of_bend) / dof;
        let row = self.terms_at(at, 1.0);
        // Runs without any scatter leave no doubt.
        let p = probability::f_upper_tail(of_bend / left, 1.0, dof).unwrap_or(0.0);
        Some((-c * row.dot(&followed), p))
    }

    /// A run as the trend carries it to grains of the real size.
    pub(crate) fn for_real_size(&self, sample: &Sample) -> Sample {
        let mut carried = sample.clone();
        for (k, name) in self.observables.iter().enumerate() {
            if let (Some((slope, _)), Some(value)) =
                (self.trend(k, &sample.at), carried.values.get_mut(name))
            {
                *value -= slope * (sample.factor - 1.0);
            }
        }
        carried
    }
}
