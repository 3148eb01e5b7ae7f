//! Fits by real runs: the declared parameters, the suspects at their own best, the model with effects added.

use super::linearisation::Linearisation;
use super::runs::{self, At, Means, Setting};
use super::whitened::difference;
use super::worker::Worker;
use super::{AddedEffect, EffectProbe, ResidualPlan, assemble, refit};
use crate::Error;
use crate::diagnosis::{CandidateResult, Diagnosis, Unseen};
use std::collections::{BTreeMap, BTreeSet};

/// Largest number of effects whose sensitivity is measured again at a time.
pub(crate) const MOST_SUSPECTS: usize = 3;
/// Blocks of seeds: of the fit without an effect and its corrections, of the model with effects and its corrections,
/// and the first of the sensitivities measured again. Block 0 is that of the start.
pub(crate) const BLOCKS_OF_FIT: [u64; 3] = [1, 4, 5];
pub(crate) const BLOCKS_WITH_EFFECTS: [u64; 4] = [2, 3, 12, 13];
pub(super) const FIRST_BLOCK_ANEW: u64 = 6;
/// Largest number of effects whose slope is noise at the probe and is measured at the largest amplitudes instead, and the
/// first of their blocks of seeds.
pub(crate) const MOST_NOISY: usize = 6;
pub(super) const FIRST_BLOCK_OF_NOISY: u64 = 14;

/// Blocks of seeds where the end of a fit with effects is corrected by the slopes about it; of several effects the first alone.
pub(crate) const BLOCKS_OF_ENDS: [u64; 2] = [33, 34];
/// An amplitude is run at twice its end for its estimate; at least so much farther, over it, or else short of it by as much.
const ROOM: f64 = 0.5;

pub(super) fn failed_run(error: &Error) -> Option<String> {
    match error {
        Error::Campaign(
            campaign::Error::Run { source, .. } | campaign::Error::Refused { source, .. },
        ) => Some(source.in_full()),
        Error::Cell { .. } => Some(error.to_string()),
        _ => None,
    }
}

/// What runs of the model with these effects gave; a warning where they failed.
fn run_or_told<T>(
    result: Result<T, Error>,
    effects: &[String],
    warnings: &mut Vec<String>,
) -> Result<Option<T>, Error> {
    match result {
        Ok(done) => Ok(Some(done)),
        Err(error) => {
            let reason = failed_run(&error).ok_or(error)?;
            let names = effects.join(" and ");
            warnings.push(format!("the model with {names} could not be run: {reason}"));
            Ok(None)
        }
    }
}

/// What the fits of a study share.
#[derive(Clone, Copy)]
pub(super) struct Fits<'a> {
    pub(super) worker: &'a Worker<'a>,
    pub(super) plan: &'a ResidualPlan,
    /// Runs of each mean at the kept conditions.
    pub(super) runs_at_kept: usize,
}

/// Effects whose sensitivity was measured again.
#[derive(Debug, Default)]
pub(super) struct Remeasured {
    /// Number of each effect and where it was run, the last look behind the others.
    pub(super) at: Vec<(usize, Visited)>,
    /// Those whose amplitude was searched: the last look is where that ended.
    pub(super) searched: BTreeSet<usize>,
    /// Slopes of the parameters beside those where they were measured there.
    pub(super) beside: BTreeMap<usize, Linearisation>,
    /// Those that could not be run.
    pub(super) warnings: Vec<String>,
}

/// A point that was run.
#[derive(Debug, Clone)]
pub(super) struct Visited {
    /// Parameters and amplitudes.
    pub(super) setting: Setting,
    /// What came out: at the used conditions, and at the kept ones where they were run.
    pub(super) means: Means,
    pub(super) block: u64,
}

/// What the data ask for about the end of a fit with effects.
#[derive(Debug, Clone)]
struct Asked {
    /// Parameters and amplitudes.
    setting: Setting,
    /// Standard errors of the parameters.
    fitted_se: BTreeMap<String, f64>,
}

/// A model with effects, fitted again by real runs at the conditions of the fit.
#[derive(Debug, Clone)]
pub(super) struct Refitted {
    pub(super) effects: Vec<String>,
    pub(super) end: Visited,
    /// What the data ask for about it.
    asked: Asked,
    /// The points with its effects that were run, as far as they are its own.
    pub(super) points: Vec<Visited>,
    /// The slopes of parameters and effects about it.
    pub(super) slopes: Linearisation,
}

impl<'a> Fits<'a> {
    /// The fits of a plan with so many runs of each mean at the kept conditions.
    pub(super) fn new(worker: &'a Worker<'a>, plan: &'a ResidualPlan, runs_at_kept: usize) -> Self {
        Self {
            worker,
            plan,
            runs_at_kept,
        }
    }

    /// Fits the declared parameters without an effect; with the points that were run on the way. The start is one of
    /// those among which the best is taken.
    pub(super) fn declared(
        &self,
        linear: &Linearisation,
    ) -> Result<(Visited, Vec<Visited>), Error> {
        let start: Vec<f64> = self.plan.parameters.iter().map(|d| d.start).collect();
        let setting = Setting::declared(self.plan, &start);
        let start = Visited {
            setting: setting.clone(),
            means: linear.nominal.clone(),
            block: 0,
        };
        let about = (&setting, &linear.nominal);
        self.descend(linear, &[], about, Some(start), BLOCKS_OF_FIT)
    }

    /// Effects whose sensitivity decides, the best explanations of what remains, each with the setting that fits best
    /// with it.
    ///
    /// A sensitivity is a difference quotient at the start, with a step of its own choice. Parameters and amplitudes end
    /// elsewhere: a real effect that the parameters have partly taken up, or that does not grow in proportion to
    /// its amplitude, is not to be judged by that straight line. What leaves the motion alone, as a camera does, keeps
    /// the fitted parameters, at which it shares their noise. No amplitude is below the smallest that can be seen, for a
    /// quotient over less is noise.
    pub(super) fn suspects(
        &self,
        linear: &Linearisation,
        fit: &Visited,
        diagnosis: &Diagnosis,
    ) -> Result<Vec<(usize, Setting)>, Error> {
        let plan = self.plan;
        let mut suspects = Vec::new();
        for (j, effect) in plan.effects.iter().enumerate() {
            let candidate = diagnosis.candidates.get(&effect.name);
            let helps = candidate.filter(|c| c.testable && c.z.is_some_and(|z| z.abs() > 2.0));
            let amplitude = helps.and_then(|c| Some((c, c.amplitude.filter(|a| *a != 0.0)?)));
            suspects.extend(amplitude.map(|(c, amplitude)| (c, j, amplitude)));
        }
        suspects.sort_by(|a, b| a.0.t_after.total_cmp(&b.0.t_after));
        suspects.truncate(MOST_SUSPECTS);
        let setting = |(candidate, j, amplitude): (&CandidateResult, usize, f64)| {
            let EffectProbe { name, range, .. } = &plan.effects[j];
            let mut setting = fit.setting.clone().with_amplitude(j, 0.0);
            let mut amplitude = amplitude;
            if !linear.shares_noise(j) {
                let about = (&setting, &fit.means);
                setting = refit::with_effects(plan, linear, std::slice::from_ref(name), about)?;
                if setting.effects[j] != 0.0 {
                    amplitude = setting.effects[j];
                }
            }
            let least = candidate.smallest_detectable.unwrap_or(0.0);
            let size = amplitude.abs().max(least);
            let amplitude = (size * amplitude.signum()).clamp(range[0], range[1]);
            Ok((j, setting.with_amplitude(j, amplitude)))
        };
        suspects.into_iter().map(setting).collect()
    }

    /// Effects whose slope is no more than noise, each at the ends of its range: more of it, not more runs, is what lifts a
    /// slope out of its noise, and what does nothing on one side may do much on the other, as friction that a bed needs to be
    /// carried along.
    pub(super) fn noisy(&self, fit: &Visited, diagnosis: &Diagnosis) -> Vec<(usize, Vec<Setting>)> {
        let effects = self.plan.effects.iter().enumerate();
        let noise = effects.filter(|(_, e)| {
            let candidate = diagnosis.candidates.get(&e.name);
            candidate.is_some_and(|c| c.unseen == Some(Unseen::SlopeIsNoise))
        });
        let at_ends = |(j, e): (usize, &EffectProbe)| {
            let ends = e.range.iter().filter(|end| **end != 0.0);
            let setting = |end: &f64| fit.setting.clone().with_amplitude(j, *end);
            (j, ends.map(setting).collect())
        };
        noise.map(at_ends).take(MOST_NOISY).collect()
    }

    /// Runs each suspect at its settings and takes its sensitivity from there; notes these runs, or that one cannot be
    /// run.
    ///
    /// Of several settings of an effect that counts at which the runs change most: that is asked of the simulator alone, so
    /// that no choice among them fits the data. An effect that shares the noise of the runs without it gets their seeds, the
    /// others those of their own block.
    pub(super) fn measured_anew(
        &self,
        mut linear: Linearisation,
        fit: &Visited,
        suspects: impl Iterator<Item = ((usize, Vec<Setting>), u64)>,
        known: &mut Remeasured,
    ) -> Result<Linearisation, Error> {
        let plan = self.plan;
        let (mut effects, mut settings) = (Vec::new(), Vec::new());
        for ((effect, of_effect), own) in suspects {
            let block = if linear.shares_noise(effect) {
                fit.block
            } else {
                own
            };
            effects.extend(of_effect.iter().map(|_| effect));
            settings.extend(of_effect.into_iter().map(|setting| (setting, block)));
        }
        let means = runs::means_of_each(self.worker, plan, &settings)?;
        let mut remeasured: Vec<(usize, f64, Visited)> = Vec::new();
        for ((effect, (setting, block)), means) in effects.into_iter().zip(settings).zip(means) {
            let name = &plan.effects[effect].name;
            match means {
                Ok(means) => {
                    let change = self.change(&linear, &fit.means, &means)?;
                    let look = Visited {
                        setting,
                        means,
                        block,
                    };
                    remeasured.push((effect, change, look));
                }
                Err(reason) => {
                    linear.not_run.insert(effect);
                    known.warnings.push(format!(
                        "{name} could not be run at the amplitude {:.3}, so that it is judged by its sensitivity \
                         elsewhere: {reason}",
                        setting.effects[effect]
                    ));
                }
            }
        }
        // The last look at an effect is the one that counts.
        remeasured.sort_by(|a, b| a.1.total_cmp(&b.1));
        for (effect, _, look) in remeasured {
            let (from, to) = ((&fit.setting, &fit.means), (&look.setting, &look.means));
            linear = linear.with_secant(effect, from, to);
            known.at.push((effect, look));
        }
        Ok(linear)
    }

    /// Fits the model with each set of effects again, by real runs; a warning for each set that cannot be run.
    pub(super) fn refitted(
        &self,
        linear: &Linearisation,
        sets: &[Vec<String>],
        fit: &Visited,
        remeasured: &mut Remeasured,
    ) -> Result<Vec<Refitted>, Error> {
        let mut models = Vec::new();
        for set in sets {
            let model = self.refit(linear, set, fit, remeasured);
            models.extend(run_or_told(model, set, &mut remeasured.warnings)?);
        }
        Ok(models)
    }

    /// Adds effects to the model that was fitted without, and fits parameters and amplitudes together.
    ///
    /// A lone effect that was measured again starts there; one whose amplitude was searched is fitted already.
    fn refit(
        &self,
        linear: &Linearisation,
        effects: &[String],
        fit: &Visited,
        remeasured: &Remeasured,
    ) -> Result<Refitted, Error> {
        let alone = |look: &&(usize, Visited)| {
            effects == std::slice::from_ref(&self.plan.effects[look.0].name)
        };
        let found = remeasured.at.iter().rev().find(alone);
        let end = if let Some((_, end)) = found.filter(|look| remeasured.searched.contains(&look.0))
        {
            end.clone()
        } else {
            let look = found.map(|look| &look.1);
            let start = look.unwrap_or(fit);
            let about = (&start.setting, &start.means);
            let best = look.cloned();
            let (end, _) = self.descend(linear, effects, about, best, BLOCKS_WITH_EFFECTS)?;
            end
        };
        let beside = found.and_then(|look| remeasured.beside.get(&look.0));
        let about = beside.unwrap_or(linear);
        let (asked, beyond, slopes) = self.asked(about, effects, &end)?;
        let number = |name: &String| self.plan.effects.iter().position(|e| e.name == *name);
        let lone = effects.first().filter(|_| effects.len() == 1);
        let searched = lone.and_then(number).filter(|j| !linear.shares_noise(*j));
        let Some(effect) = searched else {
            let points = beyond.into_iter().chain([end.clone()]).collect();
            let end = self.better_end(linear, end, &asked.setting)?;
            return Ok(Refitted {
                effects: effects.to_vec(),
                end,
                asked,
                points,
                slopes,
            });
        };
        // Whoever is compared has ended where another run would gain nothing, and not where what is left may be noise.
        let of_effect = remeasured.at.iter().filter(|look| look.0 == effect);
        let known = of_effect.map(|look| look.1.clone());
        let mut points: Vec<Visited> = known.chain([end.clone()]).chain(beyond).collect();
        let runs = (&mut BLOCKS_OF_ENDS.into_iter(), &mut Vec::new());
        let best = self.search(about, effect, fit, (&mut points, &end.setting), runs)?;
        let best = best.unwrap_or_else(|| end.clone());
        let (asked, slopes) = if best.setting == end.setting {
            (asked, slopes)
        } else {
            let (asked, beyond, slopes) = self.asked(about, effects, &best)?;
            points.extend(beyond);
            (asked, slopes)
        };
        Ok(Refitted {
            effects: effects.to_vec(),
            end: best,
            asked,
            points,
            slopes,
        })
    }

    /// Models that were fitted again with their runs at the kept conditions, what they leave, and their amplitudes; a warning for each that
    /// cannot be run there.
    pub(super) fn completed(
        &self,
        linear: &Linearisation,
        fit: &Visited,
        models: &[&Refitted],
        warnings: &mut Vec<String>,
    ) -> Result<Vec<AddedEffect>, Error> {
        let mut added = Vec::new();
        for model in models {
            let kept = self.run(&model.end.setting, model.end.block, At::Kept);
            let Some(kept) = run_or_told(kept, &model.effects, warnings)? else {
                continue;
            };
            let means = model.end.means.clone().with_kept(kept);
            added.push(AddedEffect {
                estimates: self.amplitudes(linear, fit, model)?,
                errors: assemble::errors(self.plan, linear, &means)?,
                effects: self.amplitudes_at(&model.effects, &model.end.setting),
                fitted: model.end.setting.by_name(self.plan),
                fitted_se: model.asked.fitted_se.clone(),
                runs: means.n.clone(),
                simulated: means.values,
            });
        }
        Ok(added)
    }

    /// What the data ask for about the end of a fit, by the slopes beyond it; the points that were run for these slopes, and the
    /// slopes.
    ///
    /// A fit by runs ends where what is left is noise, and not quite at the best point. What an effect does may saturate: the
    /// slope from where it is off says that an amplitude is known well which more of it would not change. So each is run at
    /// twice its end, at least by its probe farther, or short of it where its range ends before, and fitted once more by these
    /// slopes. Nearer by, they would be noise, which the fit would follow.
    fn asked(
        &self,
        linear: &Linearisation,
        effects: &[String],
        end: &Visited,
    ) -> Result<(Asked, Vec<Visited>, Linearisation), Error> {
        let plan = self.plan;
        let number = |name: &String| plan.effects.iter().position(|e| e.name == *name);
        let beyond = |j: usize| {
            let EffectProbe { probe, range, .. } = &plan.effects[j];
            let [low, high] = *range;
            let amplitude = end.setting.effects[j];
            let away = if amplitude == 0.0 { *probe } else { amplitude };
            let step = amplitude.abs().max(probe.abs()).copysign(away);
            let far = (amplitude + step).clamp(low, high);
            let is_room = (far - amplitude).abs() >= ROOM * step.abs();
            let near = (amplitude - ROOM * step).clamp(low, high);
            let there = if is_room { far } else { near };
            (j, end.setting.clone().with_amplitude(j, there))
        };
        let beyond: Vec<_> = effects.iter().filter_map(number).map(beyond).collect();
        let settings: Vec<_> = beyond.iter().map(|(_, s)| (s.clone(), end.block)).collect();
        let means = runs::means_of_each(self.worker, plan, &settings)?;
        let mut local = linear.clone();
        let mut visited = Vec::new();
        for ((j, setting), means) in beyond.into_iter().zip(means) {
            if let Ok(means) = means {
                let from = (&end.setting, &end.means);
                local = local.with_secant(j, from, (&setting, &means));
                visited.push(Visited {
                    setting,
                    means,
                    block: end.block,
                });
            }
        }
        let at = (&end.setting, &end.means);
        let errors = refit::standard_errors(plan, &local, effects, at)?;
        let setting = refit::with_effects(plan, &local, effects, at)?;
        let parameters = plan.parameters.iter().zip(&errors);
        let fitted_se = parameters.filter_map(|(d, error)| Some((d.symbol.clone(), (*error)?)));
        let asked = Asked {
            fitted_se: fitted_se.collect(),
            setting,
        };
        Ok((asked, visited, local))
    }

    /// Runs what is asked for about the end of a fit; the better of both.
    fn better_end(
        &self,
        linear: &Linearisation,
        end: Visited,
        asked: &Setting,
    ) -> Result<Visited, Error> {
        let cost = |v: &Visited| assemble::cost(self.plan, linear, &v.setting, &v.means);
        if *asked == end.setting {
            return Ok(end);
        }
        let [block, _] = BLOCKS_OF_ENDS;
        let there = match self.run(asked, block, At::Used) {
            Ok(means) => Visited {
                setting: asked.clone(),
                means,
                block,
            },
            Err(error) if failed_run(&error).is_some() => return Ok(end),
            Err(error) => return Err(error),
        };
        let is_better = cost(&there)? < cost(&end)?;
        Ok(if is_better { there } else { end })
    }

    /// Runs where the fit by the linear model about a point ends, and corrects that where it misses, with the
    /// seeds of a block each time. The point that fits best is kept; `best` is one already. Also gives all points that
    /// were run here.
    ///
    /// Without effects the slopes are those of all runs so far. With them they are corrected where runs contradict them by
    /// more than noise.
    fn descend<const ROUNDS: usize>(
        &self,
        noise: &Linearisation,
        effects: &[String],
        (start, means): (&Setting, &Means),
        best: Option<Visited>,
        blocks: [u64; ROUNDS],
    ) -> Result<(Visited, Vec<Visited>), Error> {
        let plan = self.plan;
        let cost = |v: &Visited| assemble::cost(plan, noise, &v.setting, &v.means);
        let mut linear = noise.clone();
        let mut about = (start.clone(), means.clone());
        // A point that was run for another purpose does not end the search before a fit about it was run.
        let (mut best, mut at_end) = (best, false);
        let mut all = Vec::new();
        for block in blocks {
            if let (Some(best), true) = (&best, at_end) {
                let misfit = assemble::misfit(plan, noise, &best.means)?;
                if misfit <= assemble::likely_mean_square(plan.values_of_fit()) {
                    break;
                }
            }
            let setting = refit::with_effects(plan, &linear, effects, (&about.0, &about.1))?;
            let means = match self.run(&setting, block, At::Used) {
                // A correction that cannot be run ends the search where it is.
                Err(error) if best.is_some() && failed_run(&error).is_some() => break,
                means => means?,
            };
            let from = (&about.0, &about.1);
            let corrected = linear.contradicted(plan, effects, from, (&setting, &means))?;
            let visited = Visited {
                setting,
                means,
                block,
            };
            let better = match &best {
                Some(best) => cost(&visited)? < cost(best)?,
                None => true,
            };
            at_end = true;
            all.push(visited.clone());
            if better {
                about = (visited.setting.clone(), visited.means.clone());
                best = Some(visited);
            } else if corrected.is_none() {
                break;
            }
            linear = if effects.is_empty() {
                noise.clone().with_points(&all)
            } else {
                corrected.unwrap_or(linear)
            };
        }
        let best = best.ok_or(Error::Search {
            what: "the fit",
            reason: "no point was run".into(),
        })?;
        Ok((best, all))
    }

    /// Sum of squares of the difference of two means, in standard deviations of their noise.
    fn change(&self, linear: &Linearisation, from: &Means, to: &Means) -> Result<f64, Error> {
        let runs = |c: usize| 1.0 / from.n[c] as f64 + 1.0 / to.n[c] as f64;
        let moved = |c: usize, k: usize| to.values[c][k] - from.values[c][k];
        Ok(difference(self.plan, linear, runs, moved)?.norm_squared())
    }

    fn amplitudes_at(&self, effects: &[String], point: &Setting) -> BTreeMap<String, f64> {
        let all = self.plan.effects.iter().zip(&point.effects);
        let own = all.filter(|(e, _)| effects.contains(&e.name));
        own.map(|(e, x)| (e.name.clone(), *x)).collect()
    }

    pub(super) fn run(&self, setting: &Setting, block: u64, at: At) -> Result<Means, Error> {
        match at {
            At::Used => runs::means(self.worker, self.plan, setting, block, at),
            At::Kept => {
                let plan = ResidualPlan {
                    replicates: self.runs_at_kept,
                    ..self.plan.clone()
                };
                runs::means(self.worker, &plan, setting, block, at)
            }
        }
    }
}
