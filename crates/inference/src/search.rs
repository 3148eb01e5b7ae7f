//! The search for the estimate: surfaces in a box, and the next box where the measurements are out of reach.

mod next_box;
mod shown;

use crate::designs::design_runs;
use crate::diagnosis::Whitener;
use crate::intervals::best_of;
use crate::joint_fit::{JointFit, Minimum};
use crate::region::Region;
use crate::samples::{
    Runner, Sample, Samples, Wanted, first_seed, observables, of_regime, request, usual_regime,
};
use crate::surface::{Degree, Surface, too_few};
use crate::{CalibrationProblem, Error, PlannedStage, Role, RunList, SearchBox, SurfaceDesign};
use next_box::Next;
pub(crate) use next_box::acts;
use std::collections::{BTreeMap, BTreeSet};

/// Runs of boxes before are used again up to so many half widths from the middle of the new one.
const NEAR: f64 = 1.25;
/// First stage number of the boxes; the stage sets the seeds.
const STAGE_OF_BOXES: u64 = 10;

/// Surfaces over a box and what they say.
#[derive(Debug)]
pub(crate) struct Found {
    pub(crate) region: Region,
    /// Surfaces of the models that the fit uses.
    pub(crate) surfaces: Vec<Surface>,
    /// Local minima, the best first.
    pub(crate) minima: Vec<Minimum>,
    /// Weights at the best.
    pub(crate) whitening: Whitener,
    /// Parameters that are searched.
    pub(crate) free: Vec<bool>,
    /// The best point, natural.
    pub(crate) best: Vec<f64>,
}

pub(crate) struct Search<'a> {
    runner: Runner<'a>,
    /// Parameters of each model that its surfaces see, by model.
    active: BTreeMap<usize, Vec<usize>>,
    /// Runs that the other stages need, for the budget.
    elsewhere: usize,
    /// All runs so far, by model.
    samples: BTreeMap<usize, Samples>,
    /// The regime that the surfaces of each model describe.
    regime: BTreeMap<usize, String>,
    pub(crate) boxes: Vec<SearchBox>,
    /// Remarks for the reader.
    pub(crate) remarks: Vec<String>,
}

impl<'a> Search<'a> {
    /// Prepares a search; `active` has the parameters of each model of role fit that passed the screening, `elsewhere`
    /// is the number of runs that the other stages need.
    pub(crate) fn new(
        runner: Runner<'a>,
        active: BTreeMap<usize, Vec<usize>>,
        elsewhere: usize,
    ) -> Self {
        Self {
            runner,
            active,
            elsewhere,
            samples: BTreeMap::new(),
            regime: BTreeMap::new(),
            boxes: Vec::new(),
            remarks: Vec::new(),
        }
    }

    /// The stage of the search with the parameters that passed the screening: the first box, and as many further ones as are left.
    ///
    /// # Errors
    ///
    /// A design that does not exist.
    pub(crate) fn planned(&self, stage: &PlannedStage) -> Result<PlannedStage, Error> {
        let Runner { asked, .. } = self.runner;
        let region = Region::first(&asked.problem.parameters);
        let mut requests = Vec::new();
        for (&model, active) in &self.active {
            let runs = design_runs(asked, 0, (model, active), &region)?;
            requests.extend(runs.iter().map(|w| request(asked.problem, w)));
        }
        let left = self.most_boxes() - self.boxes.len().max(1);
        Ok(PlannedStage {
            stage: stage.stage.clone(),
            certain: vec![RunList::once(requests.clone())],
            further: vec![RunList {
                times: left,
                requests,
            }],
        })
    }

    /// Searches box after box until the best point lies inside and the surfaces meet their runs, or nothing more can be done.
    ///
    /// # Errors
    ///
    /// Runs too few for any surface in the first box; a campaign that was stopped.
    pub(crate) fn run(&mut self, announce: &dyn Fn(&str)) -> Result<Found, Error> {
        let region = Region::first(&self.runner.problem.parameters);
        let why = "the box of the file".to_owned();
        let found = self.onward(region, why, None, announce)?;
        found.ok_or(Error::Search {
            what: "the estimate",
            reason: "no box was searched".into(),
        })
    }

    /// Continues in a smaller box if fresh runs at the best point, or the runs behind a surface, show that it misses them, and
    /// says whether it did; what was found before otherwise, or if no box is left.
    ///
    /// # Errors
    ///
    /// A campaign that was stopped.
    pub(crate) fn nearer(
        &mut self,
        found: Found,
        fresh: &BTreeMap<usize, Samples>,
        announce: &dyn Fn(&str),
    ) -> Result<(Found, bool), Error> {
        let boxes = self.boxes.len();
        match self.smaller(&found, fresh) {
            Next::Move(region, why) if boxes < self.most_boxes() => {
                let now = self.onward(region, why, Some(found), announce)?;
                let now = now.ok_or(Error::Search {
                    what: "the estimate",
                    reason: "no box was searched".into(),
                })?;
                Ok((now, self.boxes.len() > boxes))
            }
            _ => Ok((found, false)),
        }
    }

    fn most_boxes(&self) -> usize {
        self.runner.settings.most_boxes.max(1)
    }

    /// Searches box after box from one on; what was found before where that cannot be searched.
    fn onward(
        &mut self,
        mut region: Region,
        mut why: String,
        mut found: Option<Found>,
        announce: &dyn Fn(&str),
    ) -> Result<Option<Found>, Error> {
        while self.boxes.len() < self.most_boxes() {
            let number = self.boxes.len();
            if number > 0 {
                announce(&format!("box {}: {why}", number + 1));
            }
            let n_runs = match self.sample(&region, number) {
                Err(error @ Error::Budget { .. }) if found.is_some() => {
                    self.remarks
                        .push(format!("the search ended although {why}: {error}"));
                    break;
                }
                n_runs => n_runs?,
            };
            let (surfaces, failed) = self.surfaces(&region);
            if let (Some((_, error)), Some(_)) = (failed.first(), &found) {
                self.remarks.push(format!(
                    "the search ended although {why}, because in the next box no surface could be made: {error}"
                ));
                break;
            }
            self.leave_out(failed)?;
            let now = self.solve(region.clone(), surfaces)?;
            self.boxes.push(SearchBox {
                low: region.low.clone(),
                high: region.high.clone(),
                why: why.clone(),
                best: now.best.clone(),
                misfit: best_of(&now.minima)?.misfit,
                n_runs,
            });
            let next = self.next(&now)?;
            found = Some(now);
            match next {
                Next::Stay => break,
                Next::Move(_, reason) if self.boxes.len() == self.most_boxes() => {
                    self.remarks.push(format!(
                        "the search ended after {} boxes although {reason}: raise most_boxes, or begin nearer, with a \
                         smaller box",
                        self.boxes.len()
                    ));
                }
                Next::Move(to, reason) => (region, why) = (to, reason),
            }
        }
        Ok(found)
    }

    /// Runs the designs of the models for which a box is new; the number of new runs.
    fn sample(&mut self, region: &Region, number: usize) -> Result<usize, Error> {
        let problem = self.runner.problem;
        let mut list: Vec<Wanted> = Vec::new();
        for (&model, active) in &self.active {
            if self.knows(model, active, region) {
                continue;
            }
            let seed = first_seed(self.runner.settings, STAGE_OF_BOXES + number as u64, model);
            list.extend(design_runs(
                self.runner.asked,
                seed,
                (model, active),
                region,
            )?);
        }
        if let Some(most) = self.runner.settings.most_runs {
            let so_far: usize = self.boxes.iter().map(|b| b.n_runs).sum();
            let needed = self.elsewhere + so_far + list.len();
            if needed > most {
                return Err(Error::Budget { needed, most });
            }
        }
        for (model, new) in self.runner.run(&list)? {
            let regime = self.regime.entry(model);
            regime.or_insert_with(|| usual_regime(&new.done));
            let known = self.samples.entry(model).or_default();
            known.done.extend(new.done);
            known.failed.extend(new.failed);
        }
        debug_assert!(
            problem.models.len() >= self.samples.len(),
            "a sample belongs to a model"
        );
        Ok(list.len())
    }

    /// Whether a model was sampled in a box with the same ranges of its parameters.
    fn knows(&self, model: usize, active: &[usize], region: &Region) -> bool {
        let same = |b: &SearchBox| {
            active
                .iter()
                .all(|&j| b.low[j] == region.low[j] && b.high[j] == region.high[j])
        };
        self.samples.contains_key(&model) && self.boxes.iter().any(same)
    }

    /// Continues without the models of which no surface can be made; their measurements are not met.
    ///
    /// # Errors
    ///
    /// [`Error::TooFewRuns`] if no other model is left.
    fn leave_out(&mut self, failed: Vec<(usize, Error)>) -> Result<(), Error> {
        for (model, error) in failed {
            if self.active.len() == 1 {
                return Err(error);
            }
            self.active.remove(&model);
            let name = &self.runner.problem.models[model].name;
            self.remarks
                .push(format!("the fit is made without {name}: {error}"));
        }
        Ok(())
    }

    /// Surfaces over the runs that lie in a box or near it, in their usual regime, and the models of which none can be made.
    fn surfaces(&self, region: &Region) -> (Vec<Surface>, Vec<(usize, Error)>) {
        let (mut surfaces, mut failed) = (Vec::new(), Vec::new());
        for (&model, active) in &self.active {
            let samples = self.samples.get(&model).cloned().unwrap_or_default();
            let regime = self.regime.get(&model).cloned().unwrap_or_default();
            let (inside, outside) = of_regime(&samples.done, &regime);
            let near: Vec<&Sample> = near(inside, active, region);
            let names = observables(self.runner.problem, model);
            let most = match self.runner.settings.surface {
                SurfaceDesign::Linear => Degree::Linear,
                _ => Degree::Quadratic,
            };
            let inputs = self.runner.problem.inputs_of(model);
            let surface = Surface::fit((model, active, &inputs), &names, region, &near, most);
            let enough = surface.filter(|s| active.is_empty() || s.degree != Degree::Constant);
            if let Some(surface) = enough {
                surfaces.push(surface);
                continue;
            }
            let other = outside.iter().map(|(_, reason)| reason.clone());
            let of_failed = samples.failed.iter().map(|(_, reason)| reason.clone());
            let reasons: BTreeSet<_> = other.chain(of_failed).collect();
            let reasons: Vec<_> = reasons.into_iter().collect();
            let name = &self.runner.problem.models[model].name;
            failed.push((model, too_few(name, near.len(), &reasons)));
        }
        (surfaces, failed)
    }

    /// The best point over surfaces in a box.
    pub(crate) fn solve(&self, region: Region, surfaces: Vec<Surface>) -> Result<Found, Error> {
        let fit = JointFit::new(self.runner.problem, &region, &surfaces, &[Role::Fit]);
        let (minima, whitening) = fit.solve(self.runner.settings.seed)?;
        let best = fit.natural(&best_of(&minima)?.coded);
        let free = fit.free.clone();
        Ok(Found {
            region,
            surfaces,
            minima,
            whitening,
            free,
            best,
        })
    }

    /// The runs behind the surface of a model in a box.
    pub(crate) fn used(&self, surface: &Surface, region: &Region) -> Vec<&Sample> {
        let samples = self.samples.get(&surface.model);
        let done = samples.map_or(&[][..], |samples| &samples.done);
        let (inside, _) = of_regime(done, self.regime(surface.model));
        near(inside, &surface.parameters, region)
    }

    /// The regime that the surfaces of a model describe; empty if the simulator has none.
    pub(crate) fn regime(&self, model: usize) -> &str {
        self.regime.get(&model).map_or("", String::as_str)
    }
}

impl Found {
    /// The joint fit over the surfaces.
    pub(crate) fn fit<'f>(&'f self, problem: &'f CalibrationProblem) -> JointFit<'f> {
        JointFit::new(problem, &self.region, &self.surfaces, &[Role::Fit])
    }
}

/// Runs that lie in a box or near it.
fn near<'s>(samples: Vec<&'s Sample>, active: &[usize], region: &Region) -> Vec<&'s Sample> {
    let is_near = |s: &&Sample| {
        active
            .iter()
            .all(|&j| region.coded(j, s.at[j]).abs() <= NEAR)
    };
    samples.into_iter().filter(is_near).collect()
}
