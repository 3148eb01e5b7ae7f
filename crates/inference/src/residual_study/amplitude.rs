//! The amplitude of an effect by runs at several amplitudes: its estimate and its interval.

use super::amplitude_curve::{Curve, Node, Runs};
use super::fits::{Fits, Refitted, Visited};
use super::linearisation::Linearisation;
use super::runs::{self, Means, Setting};
use super::whitened::whitened_runs;
use super::{assemble, refit};
use crate::Error;
use crate::diagnosis::Amplitude;
use nalgebra::{DMatrix, DVector};
use probability::t_two_sided_quantile;
use std::collections::BTreeMap;

/// Most amplitudes that are run for the intervals of one model, beyond those of its fit.
pub(crate) const MOST_AMPLITUDES: usize = 3;
/// Distance to a run, over that to the estimate, from which on an end of the interval is run itself.
const NEAR: f64 = 0.25;

impl Fits<'_> {
    /// The amplitudes of a model with their intervals, by further runs at the ends of these; without those of which runs at one
    /// amplitude alone are known.
    pub(super) fn amplitudes(
        &self,
        linear: &Linearisation,
        fit: &Visited,
        model: &Refitted,
    ) -> Result<BTreeMap<String, Amplitude>, Error> {
        let mut found = BTreeMap::new();
        let mut points = vec![model.end.clone()];
        if model.effects.len() == 1 {
            points.push(fit.clone());
        }
        points.extend(model.points.iter().cloned());
        let numbers = model.effects.iter();
        let numbers =
            numbers.filter_map(|name| self.plan.effects.iter().position(|e| e.name == *name));
        for effect in numbers {
            let most = (MOST_AMPLITUDES / model.effects.len()).max(1);
            let amplitude = self.amplitude(linear, model, effect, (&mut points, most))?;
            let name = &self.plan.effects[effect].name;
            found.extend(amplitude.map(|amplitude| (name.clone(), amplitude)));
        }
        Ok(found)
    }

    /// The amplitude of one effect of a model, by points and so many further runs.
    fn amplitude(
        &self,
        linear: &Linearisation,
        model: &Refitted,
        effect: usize,
        (points, most): (&mut Vec<Visited>, usize),
    ) -> Result<Option<Amplitude>, Error> {
        let probe = &self.plan.effects[effect];
        let end = model.end.setting.effects[effect];
        let mut left = most;
        loop {
            let Some(curve) = self.curve(linear, model, effect, points)? else {
                return Ok(None);
            };
            let amplitude = curve.amplitude(end, probe.range);
            let [low, high] = amplitude.interval95;
            let is_far = |x: &f64| !curve.is_known(*x, NEAR * (amplitude.value - x).abs());
            let far = [high, low].into_iter().filter(is_far).take(left);
            let settings: Vec<(Setting, u64)> = far
                .map(|x| (self.at_amplitude(model, effect, &curve, x), model.end.block))
                .collect();
            if settings.is_empty() {
                return Ok(Some(amplitude));
            }
            left -= settings.len();
            let means = runs::means_of_each(self.worker, self.plan, &settings)?;
            let visited =
                settings
                    .into_iter()
                    .zip(means)
                    .filter_map(|((setting, block), means)| {
                        let means = means.ok()?;
                        Some(Visited {
                            setting,
                            means,
                            block,
                        })
                    });
            let before = points.len();
            points.extend(visited);
            if points.len() == before {
                return Ok(Some(amplitude));
            }
        }
    }

    /// The setting of a model at another amplitude of an effect, the rest re-tuned as the runs along it promise.
    fn at_amplitude(&self, model: &Refitted, effect: usize, curve: &Curve, x: f64) -> Setting {
        let step = curve.step_at(x);
        let mut setting = model.end.setting.clone();
        let (of_parameters, of_effects) = step.as_slice().split_at(self.plan.parameters.len());
        let declared = setting.parameters.iter_mut().zip(&self.plan.parameters);
        for ((value, d), step) in declared.zip(of_parameters) {
            *value = (*value + step).clamp(d.limits[0], d.limits[1]);
        }
        for (j, step) in self.others(model, effect).into_iter().zip(of_effects) {
            let [low, high] = self.plan.effects[j].range;
            setting.effects[j] = (setting.effects[j] + step).clamp(low, high);
        }
        setting.with_amplitude(effect, x)
    }

    fn others(&self, model: &Refitted, effect: usize) -> Vec<usize> {
        let effects = self.plan.effects.iter().enumerate();
        let others = effects.filter(|(j, e)| *j != effect && model.effects.contains(&e.name));
        others.map(|(j, _)| j).collect()
    }

    /// The curve of an effect through points; `None` if they are all at one amplitude.
    fn curve(
        &self,
        linear: &Linearisation,
        model: &Refitted,
        effect: usize,
        points: &[Visited],
    ) -> Result<Option<Curve>, Error> {
        let plan = self.plan;
        let others = self.others(model, effect);
        let end = refit::values_at(&others, &model.end.setting);
        let bounds = |e: usize| {
            let declared = plan.parameters.iter().map(move |d| d.limits[e]);
            declared.chain(others.iter().map(move |&j| plan.effects[j].range[e]))
        };
        let ways = [0, 1].map(|e| {
            bounds(e)
                .zip(&end)
                .map(|(b, at)| b - at)
                .collect::<Vec<f64>>()
        });
        // A point that rounding put outside begins on its bound.
        let ways = [
            ways[0].iter().map(|x| x.min(0.0)).collect(),
            ways[1].iter().map(|x| x.max(0.0)).collect(),
        ];
        let mut slopes = DMatrix::zeros(0, end.len());
        let mut nodes: Vec<Node> = Vec::new();
        for point in points {
            // All are whitened alike.
            let means = Means {
                n: model.end.means.n.clone(),
                ..point.means.clone()
            };
            let at = refit::values_at(&others, &point.setting);
            let (matrix, target) =
                refit::linear_problem(plan, &model.slopes, &others, (&at, &means))?;
            let moved =
                DVector::from_iterator(end.len(), end.iter().zip(&at).map(|(to, from)| to - from));
            nodes.push(Node {
                amplitude: point.setting.effects[effect],
                residual: target - &matrix * moved,
                block: point.block,
            });
            slopes = matrix;
        }
        let dof = assemble::covariance_dof(plan, linear, &model.end.means);
        let runs = Runs {
            own_noise: linear.own_noise(effect),
            covariance: whitened_runs(plan, linear, &model.end.means, slopes.nrows())?,
            quantile: t_two_sided_quantile(0.05, dof).unwrap_or(f64::INFINITY),
            nodes,
            slopes,
            ways,
        };
        let [low, high] = plan.effects[effect].range;
        let end = model.end.setting.effects[effect];
        Ok(Curve::new(runs, end, low.abs().max(high.abs())))
    }
}
