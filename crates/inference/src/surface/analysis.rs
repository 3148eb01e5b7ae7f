//! The analysis of variance that a report shows, of the surface that was used.

use super::{Surface, model_of};
use crate::samples::Sample;
use crate::{CalibrationProblem, CoarseGraining};
use experiment_design::Factor;
use response_surface::{Cell, Fit, Observations, fit};

impl Surface {
    /// The analysis of an observable over the runs behind this surface: the same polynomial, raised as fresh runs have shifted it. Inputs
    /// are held as they were stated, and the grains at the real size. `None` if the analysis is undefined.
    pub(crate) fn analysis(
        &self,
        problem: &CalibrationProblem,
        used: &[&Sample],
        k: usize,
    ) -> Option<Fit> {
        let of_parameter = |&j: &usize| {
            let p = &problem.parameters[j];
            let [low, high] = [self.region.low[j], self.region.high[j]];
            Factor::new(&p.symbol, &p.name, &p.unit, low, high)
        };
        // Its coded values are those of the surface: 0 at the real size, 1 at the coarsest.
        let of_size = |one: f64| Factor::new(CoarseGraining::SYMBOL, "", "1", 1.0 - one, 1.0 + one);
        let factors = self.parameters.iter().map(of_parameter);
        let factors: Vec<Factor> = factors
            .chain(self.coarsest.map(of_size))
            .collect::<Result<_, _>>()
            .ok()?;
        let symbols = factors.iter().map(|f| f.symbol().to_owned()).collect();
        let model = model_of(symbols, (self.degree, self.curved, self.crossed));
        let run =
            |s: &&Sample| Cell::single(self.coded(&s.at, s.factor), s.values[&self.observables[k]]);
        let data = Observations::from_cells(used.iter().map(run).collect()).ok()?;
        let mut found = fit(&factors, &model, &data).ok()?;
        let start = problem.start();
        let stated = self
            .coded(&start, 1.0)
            .into_iter()
            .enumerate()
            .skip(self.curved);
        let stated: Vec<(usize, f64)> = stated.collect();
        if !stated.is_empty() {
            found = found.held(&stated).ok()?;
            found.box_extremes = found.extremes().ok();
        }
        Some(found.raised(self.shift(k)))
    }
}

#[cfg(test)]
mod tests {
    use crate::surface::tests::{grid, region, sample};
    use crate::surface::{Degree, Surface};
    use crate::{CalibrationProblem, Parameter};

    /// The analysis shown is that of the surface in use: the same value everywhere, shifted to the fresh runs, the leverage before them and the
    /// variance of a run, with an input and coarse grains as well, which are held as stated and at the real size (rounding).
    #[test]
    fn the_analysis_is_that_of_the_surface() {
        let input = Parameter {
            start: 20.0,
            is_input: true,
            ..Parameter::new("B", [10.0, 30.0])
        };
        let problem = CalibrationProblem {
            parameters: vec![Parameter::new("A", [0.0, 2.0]), input],
            ..CalibrationProblem::default()
        };
        let mut samples = grid();
        for (i, sample) in samples.iter_mut().enumerate() {
            sample.factor = if i % 3 == 0 { 2.0 } else { 3.0 };
            let noise = 0.1 * [1.0, -2.0, 0.5, 1.5, -1.0][i % 5];
            sample
                .values
                .insert("y".into(), sample.values["y"] + 0.3 * sample.factor + noise);
        }
        let used: Vec<_> = samples.iter().collect();
        let fresh = sample(0.5, 20.0, 4.0);
        let (names, most) = (["y".to_owned()], Degree::Quadratic);
        for (tuned, inputs) in [(&[0, 1][..], &[][..]), (&[0][..], &[1][..])] {
            let plain = Surface::fit((0, tuned, inputs), &names, &region(), &used, most).unwrap();
            let surface = plain.anchored(&[&fresh]);
            let shown = surface.analysis(&problem, &used, 0).unwrap();
            assert_eq!(shown.factors.len(), tuned.len());
            assert!((shown.mse.unwrap() - surface.covariance[(0, 0)]).abs() < 1e-12);
            for at in [[0.3, 20.0], [1.9, 20.0]] {
                let coded = shown.coded(&at[..tuned.len()]);
                assert!((shown.value(&coded) - surface.value(0, &at)).abs() < 1e-12);
                assert!((shown.leverage(&coded) - plain.leverage(&at)).abs() < 1e-12);
            }
        }
    }
}
