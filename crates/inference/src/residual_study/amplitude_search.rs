//! The amplitude of an effect that does not grow in proportion, by real runs.

use super::fits::{Fits, Remeasured, Visited, failed_run};
use super::linearisation::Linearisation;
use super::runs::{self, At, Means, Setting};
use super::{ResidualPlan, assemble, refit};
use crate::diagnosis::Diagnosis;
use crate::{Error, Parameter};

/// Blocks of seeds of the search, one a point: those that the best suspects leave are for the others.
pub(crate) const BLOCKS_OF_SEARCH: [u64; 6] = [21, 22, 23, 24, 25, 26];
/// Blocks of seeds of the search that continues with slopes of the parameters beside the effect.
pub(crate) const BLOCKS_OF_FURTHER_SEARCH: [u64; 6] = [27, 28, 29, 30, 31, 32];
/// Most points of one suspect in each search.
pub(crate) const MOST_POINTS: usize = 4;
/// Drop of the deviance below which another point is not worth its runs: that of one parameter by chance.
const WORTH_A_RUN: f64 = 1.0;

/// Difference of two amplitudes over the larger from which on their slope is used beyond them.
const APART: f64 = 0.2;

/// How much farther than its slope promises a point beyond the others is run.
const FARTHER: f64 = 3.0;

/// Part of what the best suspect explains from which on another is searched too.
pub(super) const WORTH_A_SEARCH: f64 = 0.5;

/// A stretch of amplitudes between two points that were run, or beyond the last.
struct Stretch {
    /// The point that it is measured from.
    from: Visited,
    linear: Linearisation,
    /// Least and largest amplitude.
    range: [f64; 2],
    /// Whether it lies beyond what was run.
    is_beyond: bool,
}

/// The suspects, the best explanations first, that explain a good part of what the best of them does: no bend makes up for
/// the rest.
pub(super) fn worth_a_search(
    diagnosis: &Diagnosis,
    plan: &ResidualPlan,
    suspects: Vec<(usize, Setting)>,
) -> Vec<(usize, Setting)> {
    let whole = diagnosis.structured_residual.t0.unwrap_or(0.0);
    let explained = |j: usize| {
        let candidate = diagnosis.candidates.get(&plan.effects[j].name);
        candidate.map_or(0.0, |c| whole - c.t_after)
    };
    let most = suspects.first().map_or(0.0, |best| explained(best.0));
    let mut kept = suspects;
    kept.retain(|(j, _)| explained(*j) >= WORTH_A_SEARCH * most);
    kept
}

impl Fits<'_> {
    /// Searches the amplitudes of suspects, and takes their sensitivities from where they end.
    ///
    /// A straight line from the fit without a bent effect ends short of it, and what remains there is none of the effect's.
    /// Between the amplitudes that were run what the effect does is interpolated, beyond the last it continues; parameters and
    /// amplitude are fitted, run, and the point is added, until another would gain nothing. What is left in the end is what
    /// runs leave. An effect that shares the noise of the fit, as a camera does, keeps its sensitivity.
    ///
    /// Beside an effect the parameters may act otherwise than without it: friction holds a bed at rest, and little of one that
    /// is shaken. Where more than noise is left, their slopes are measured at the best point, and the search continues with these.
    pub(super) fn searched(
        &self,
        mut linear: Linearisation,
        fit: &Visited,
        suspects: &[(usize, Setting)],
        known: &mut Remeasured,
    ) -> Result<Linearisation, Error> {
        let mut blocks = BLOCKS_OF_SEARCH.into_iter();
        let mut further = BLOCKS_OF_FURTHER_SEARCH.into_iter();
        for (effect, setting) in suspects {
            let effect = *effect;
            if linear.shares_noise(effect) {
                continue;
            }
            let remeasured = known.at.iter().filter(|look| look.0 == effect);
            let remeasured: Vec<Visited> = remeasured.map(|look| look.1.clone()).collect();
            let mut points = remeasured.clone();
            let warnings = &mut known.warnings;
            let runs = (&mut blocks, &mut *warnings);
            let found = self.search(&linear, effect, fit, (&mut points, setting), runs)?;
            let Some(mut end) = found else {
                continue;
            };
            if self.leaves_structure(&linear, &end)?
                && let Some(beside) = self.slopes_beside(&linear, &end)?
            {
                let runs = (&mut further, warnings);
                let found = self.search(&beside, effect, fit, (&mut points, setting), runs)?;
                end = found.unwrap_or(end);
                known.beside.insert(effect, beside);
            }
            if remeasured.iter().all(|look| look.setting != end.setting) {
                let from = (&fit.setting, &fit.means);
                linear = linear.with_secant(effect, from, (&end.setting, &end.means));
                known.at.push((effect, end));
                known.searched.insert(effect);
            }
        }
        Ok(linear)
    }

    /// Whether runs at a point leave more than noise.
    fn leaves_structure(&self, linear: &Linearisation, at: &Visited) -> Result<bool, Error> {
        let misfit = assemble::misfit(self.plan, linear, &at.means)?;
        let values = self.plan.values_of_fit();
        Ok(misfit > assemble::likely_mean_square(values))
    }

    /// The slopes of the parameters beside a point at which an effect is on, with its seeds; `None` if a step cannot be run.
    fn slopes_beside(
        &self,
        linear: &Linearisation,
        at: &Visited,
    ) -> Result<Option<Linearisation>, Error> {
        let moved = |(j, d): (usize, &Parameter)| {
            let mut setting = at.setting.clone();
            let value = setting.parameters[j] + d.step_from(setting.parameters[j]);
            setting.parameters[j] = value.clamp(d.limits[0], d.limits[1]);
            (setting, at.block)
        };
        let declared = self.plan.parameters.iter().enumerate();
        let settings: Vec<_> = declared.map(moved).collect();
        let means = runs::means_of_each(self.worker, self.plan, &settings)?;
        let means: Option<Vec<Means>> = means.into_iter().map(Result::ok).collect();
        let Some(means) = means else {
            return Ok(None);
        };
        let length = |(j, (setting, _)): (usize, &(Setting, u64))| {
            setting.parameters[j] - at.setting.parameters[j]
        };
        let lengths = settings.iter().enumerate().map(length);
        let steps: Vec<(Means, f64)> = means.into_iter().zip(lengths).collect();
        Ok(Some(linear.clone().with_slopes_beside(&at.means, &steps)))
    }

    /// The point with an effect that fits best, from points that were run and where to begin without one; `None` if
    /// nothing could be run. Each new point takes a block of seeds, as long as there is one, and joins the others.
    pub(super) fn search(
        &self,
        linear: &Linearisation,
        effect: usize,
        fit: &Visited,
        (points, begin): (&mut Vec<Visited>, &Setting),
        (blocks, warnings): (&mut impl Iterator<Item = u64>, &mut Vec<String>),
    ) -> Result<Option<Visited>, Error> {
        let plan = self.plan;
        let cost = |v: &Visited| assemble::cost(plan, linear, &v.setting, &v.means);
        let mut best: Option<(f64, Visited)> = None;
        for point in points.iter() {
            better(&mut best, cost(point)?, point);
        }
        for _ in 0..MOST_POINTS {
            let setting = match &best {
                None => begin.clone(),
                Some((lowest, _)) => {
                    match self.next_point(linear, effect, fit, points, *lowest)? {
                        Some(setting) => setting,
                        None => break,
                    }
                }
            };
            let Some(block) = blocks.next() else {
                break;
            };
            let means = match self.run(&setting, block, At::Used) {
                Ok(means) => means,
                Err(error) => {
                    let reason = failed_run(&error).ok_or(error)?;
                    let name = &plan.effects[effect].name;
                    warnings.push(format!(
                        "the search for the amplitude of {name} ends at {:.3}, which could not be run: {reason}",
                        setting.effects[effect]
                    ));
                    break;
                }
            };
            let point = Visited {
                setting,
                means,
                block,
            };
            better(&mut best, cost(&point)?, &point);
            points.push(point);
        }
        Ok(best.map(|(_, point)| point))
    }

    /// Where to run next: where the stretches promise the least cost; `None` if that is not a gain worth its runs.
    fn next_point(
        &self,
        linear: &Linearisation,
        effect: usize,
        fit: &Visited,
        points: &[Visited],
        lowest: f64,
    ) -> Result<Option<Setting>, Error> {
        let mut next: Option<(f64, Setting)> = None;
        for stretch in self.stretches(linear, effect, fit, points) {
            let (promised, setting) = self.best_of(linear, &stretch, effect)?;
            let is_new = points.iter().all(|point| point.setting != setting);
            if is_new && next.as_ref().is_none_or(|(other, _)| promised < *other) {
                next = Some((promised, setting));
            }
        }
        let worth = next.filter(|(promised, _)| *promised < lowest - WORTH_A_RUN);
        Ok(worth.map(|(_, setting)| setting))
    }

    /// The stretches between neighbouring amplitudes of the points, from the fit without the effect on, and one beyond the
    /// last.
    fn stretches(
        &self,
        linear: &Linearisation,
        effect: usize,
        fit: &Visited,
        points: &[Visited],
    ) -> Vec<Stretch> {
        let [low, high] = self.plan.effects[effect].range;
        let amplitude = |v: &Visited| v.setting.effects[effect];
        let mut sorted: Vec<Visited> = points.iter().chain([fit]).cloned().collect();
        sorted.sort_by(|a, b| amplitude(a).total_cmp(&amplitude(b)));
        sorted.dedup_by(|a, b| amplitude(a) == amplitude(b));
        let between = |a: &Visited, b: &Visited, range: [f64; 2], is_beyond: bool| {
            let (from, to) = ((&a.setting, &a.means), (&b.setting, &b.means));
            Stretch {
                from: a.clone(),
                linear: linear.clone().with_secant(effect, from, to),
                range,
                is_beyond,
            }
        };
        let pairs = sorted.windows(2);
        let mut all: Vec<Stretch> = pairs
            .map(|w| between(&w[0], &w[1], [amplitude(&w[0]), amplitude(&w[1])], false))
            .collect();
        // Between two amplitudes that are near each other the slope is noise: no matter inside, but not beyond.
        let apart = |a: &Visited, b: &Visited| {
            let size = amplitude(a).abs().max(amplitude(b).abs());
            (amplitude(a) - amplitude(b)).abs() >= APART * size
        };
        if let Some((last, before)) = sorted.split_last()
            && let Some(other) = before.iter().rev().find(|v| apart(v, last))
        {
            all.push(between(last, other, [amplitude(last), high], true));
        }
        if let Some((first, behind)) = sorted.split_first()
            && let Some(other) = behind.iter().find(|v| apart(v, first))
        {
            all.push(between(first, other, [low, amplitude(first)], true));
        }
        all.retain(|stretch| stretch.range[0] < stretch.range[1]);
        all
    }

    /// The setting of a stretch to be run, and the cost that its best promises.
    fn best_of(
        &self,
        noise: &Linearisation,
        stretch: &Stretch,
        effect: usize,
    ) -> Result<(f64, Setting), Error> {
        let Stretch {
            from,
            linear,
            range,
            is_beyond,
        } = stretch;
        let mut plan: ResidualPlan = self.plan.clone();
        plan.effects[effect].range = *range;
        let name = plan.effects[effect].name.clone();
        let about = (&from.setting, &from.means);
        let names = std::slice::from_ref(&name);
        let mut setting = refit::with_effects(&plan, linear, names, about)?;
        let promised: Means = linear.means_at(effect, about, &setting);
        let cost = assemble::cost(&plan, noise, &setting, &promised)?;
        if *is_beyond {
            // What bends continues bending: a point too far lies on the other side, one too near does not.
            let end = from.setting.effects[effect];
            let farther = end + FARTHER * (setting.effects[effect] - end);
            setting.effects[effect] = farther.clamp(range[0], range[1]);
        }
        Ok((cost, setting))
    }
}

/// Takes a point where it costs less than the best so far.
fn better(best: &mut Option<(f64, Visited)>, cost: f64, point: &Visited) {
    if best.as_ref().is_none_or(|(lowest, _)| cost < *lowest) {
        *best = Some((cost, point.clone()));
    }
}
