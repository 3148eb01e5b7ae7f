//! The surfaces of a search as a result shows them.

use super::{Found, Search};
use crate::designs::surface_design;
use crate::samples::{Sample, of_regime};
use crate::{Error, LeftOut, ModelSurfaces};

impl Search<'_> {
    /// The surfaces of the result, over the parameters that are tuned. Their points are the runs with the inputs as stated and the
    /// coarsest grains, carried to the real size.
    pub(crate) fn model_surfaces(&self, found: &Found) -> Result<Vec<ModelSurfaces>, Error> {
        let problem = self.runner.problem;
        let mut shown = Vec::new();
        for surface in &found.surfaces {
            let model = surface.model;
            let samples = self.samples.get(&model).cloned().unwrap_or_default();
            let regime = self.regime.get(&model).cloned().unwrap_or_default();
            let (_, outside) = of_regime(&samples.done, &regime);
            let stated = |s: &&Sample| {
                let inputs = problem.inputs_of(model);
                inputs
                    .iter()
                    .all(|&j| s.at[j] == problem.parameters[j].start)
            };
            let all = self.used(surface, &found.region);
            let mut used = all.clone();
            used.retain(stated);
            used.retain(|s| s.factor == problem.coarsest_of(model));
            let used: Vec<Sample> = used.into_iter().map(|s| surface.for_real_size(s)).collect();
            let own = |at: &[f64]| -> Vec<f64> { surface.tuned().iter().map(|&j| at[j]).collect() };
            let other = outside.iter().map(|(s, reason)| (&s.at, reason));
            let failed = samples.failed.iter().map(|(at, reason)| (at, reason));
            let left_out = other.chain(failed).map(|(at, reason)| LeftOut {
                point: own(at),
                reason: reason.clone(),
            });
            let symbols = problem.symbols(surface.tuned());
            let value = |k: usize, s: &Sample| s.values[&surface.observables[k]];
            shown.push(ModelSurfaces {
                model: problem.models[model].name.clone(),
                design: surface_design(&symbols, self.runner.settings)?.name,
                n_runs: all.len(),
                left_out: left_out.collect(),
                points: used.iter().map(|s| own(&s.at)).collect(),
                keys: used.iter().map(|s| s.key.clone()).collect(),
                values: surface.by_observable(|k| used.iter().map(|s| value(k, s)).collect()),
                shifts: surface.by_observable(|k| surface.shift(k)),
                fits: surface.by_observable(|k| surface.analysis(problem, &all, k)),
                symbols,
            });
        }
        Ok(shown)
    }
}
