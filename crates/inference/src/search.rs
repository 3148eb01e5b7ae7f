//! The search for the estimate: surfaces in a box, and the next box where the measurements are out of reach.

use crate::designs::{slope_design, surface_design};
use crate::diagnosis::Whitener;
use crate::intervals::best_of;
use crate::joint_fit::{JointFit, Minimum};
use crate::lack_of_fit::{Missed, missed};
use crate::region::Region;
use crate::samples::{
    Asked, Runner, Sample, Samples, Wanted, first_seed, observables, request, wanted,
};
use crate::surface::{Degree, Surface, of_regime, too_few, usual_regime};
use crate::{
    CalibrationProblem, Error, LeftOut, ModelSurfaces, PlannedStage, Role, RunList, SearchBox,
    SurfaceDesign,
};
use input::quantity::significant;
use nalgebra::{DMatrix, DVector};
use std::collections::{BTreeMap, BTreeSet};

/// A coordinate so near to 1 lies on the face of the box.
const ON_THE_FACE: f64 = 0.999;
/// Slope over its standard error from which a parameter counts as acting on an observable.
const ACTS: f64 = 3.0;
/// Fall of Q behind the face that is worth a new box: 0.05 is a fifth of a standard error.
const WORTH: f64 = 0.05;
/// Runs of boxes before are used again up to so many half widths from the middle of the new one.
const NEAR: f64 = 1.25;
/// Singular values below this are those of columns that do nothing.
const IMITATED: f64 = 1e-12;
/// Least and largest way from a face to the middle of the next box, in half widths.
const WAY: [f64; 2] = [0.25, 2.0];
/// Width of the next box over that of one whose surfaces miss their runs.
const NEARER: f64 = 0.4;
/// Runs with finer grains of a model that no parameter acts on.
const FINER_AT_A_POINT: usize = 4;
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
    /// What a reader should know.
    pub(crate) remarks: Vec<String>,
}

/// Where the search goes from a box.
enum Next {
    /// Nowhere: what is best lies inside, or where nothing is to be gained beyond, and the surfaces meet their runs.
    Stay,
    /// To another box, with the reason.
    Move(Region, String),
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

    /// Goes on in a smaller box where fresh runs at the best point, or the runs behind a surface, tell that it misses them, and
    /// says whether it did; what was found before otherwise, or where no box is left.
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

    /// Goes on without the models of which no surface can be made; their measurements are not met.
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

    /// Where the search goes from a box.
    ///
    /// The box moves along every parameter whose face holds the best point back from a lower misfit, if the parameter
    /// acts on a measured observable beyond doubt: the slope of a dead one is noise. It moves as far as the plane
    /// through the best point says, and grows with the way.
    fn next(&self, found: &Found) -> Result<Next, Error> {
        let parameters = &self.runner.problem.parameters;
        let fit = found.fit(self.runner.problem);
        let best = best_of(&found.minima)?;
        let (r, jacobian) = fit.residuals(&best.coded, &found.whitening, &[]);
        let (mut centre, mut half) = (found.region.middle(), Vec::new());
        let mut moved = Vec::new();
        for (j, parameter) in parameters.iter().enumerate() {
            half.push(found.region.half(j));
            let x = best.coded[j];
            let face = found.region.natural(j, x.signum());
            let at_limit = face <= parameter.limits[0] || face >= parameter.limits[1];
            let column = with_others(&fit, &jacobian, best, j);
            let pull = -column.dot(&r) * x.signum();
            let information = column.norm_squared();
            let gain = pull * pull / information;
            let outward = fit.free[j] && x.abs() > ON_THE_FACE && pull > 0.0;
            // A curved surface is known best in the middle of the box, and may be flat there.
            let middle = found.region.middle();
            let acting = acts(&fit, j, &found.best) || acts(&fit, j, &middle);
            if !outward || at_limit || gain < WORTH || !acting {
                continue;
            }
            let way = (pull / information).clamp(WAY[0], WAY[1]);
            centre[j] = face + x.signum() * way * half[j];
            half[j] *= way.max(1.0);
            moved.push(format!(
                "{} {} {}",
                parameter.symbol,
                if x > 0.0 { "above" } else { "below" },
                significant(face, 4)
            ));
        }
        if moved.is_empty() {
            return Ok(self.smaller(found, &BTreeMap::new()));
        }
        let region = Region::about(&centre, &half, parameters);
        Ok(Next::Move(
            region,
            format!("the misfit falls towards {}", moved.join(", ")),
        ))
    }

    /// A smaller box about the best point, along the parameters of the surfaces that miss their runs; nowhere where none does.
    ///
    /// What is curved otherwise than a polynomial is less so in a smaller box. But there slopes are known less well: along a
    /// parameter whose slope would no longer stand out of its noise the box stays.
    fn smaller(&self, found: &Found, fresh: &BTreeMap<usize, Samples>) -> Next {
        let problem = self.runner.problem;
        let (mut half, mut centre) = (found.region.halves(), found.region.middle());
        let mut worst: Option<Missed> = None;
        for surface in &found.surfaces {
            let at_best = fresh.get(&surface.model).map_or(&[][..], |runs| &runs.done);
            let (at_best, _) = of_regime(at_best, self.regime(surface.model));
            let used = self.used(surface, &found.region);
            for missed in missed(problem, surface, &used, (&found.best, &at_best)) {
                // A curved surface may be flat at its best point.
                let stays_known = |j: usize| {
                    let at = [found.best.clone(), found.region.middle()];
                    let z = at.map(|at| missed.slope_in_errors(surface, j, &at).abs());
                    NEARER * z[0].max(z[1]) > ACTS
                };
                let along: Vec<usize> = self.active[&surface.model]
                    .iter()
                    .copied()
                    .filter(|&j| stays_known(j))
                    .collect();
                for &j in &along {
                    half[j] = NEARER * found.region.half(j);
                    centre[j] = found.best[j];
                }
                let is_worse = |other: &Missed| missed.in_errors > other.in_errors;
                if !along.is_empty() && worst.as_ref().is_none_or(is_worse) {
                    worst = Some(missed);
                }
            }
        }
        worst.map_or(Next::Stay, |worst| {
            let region = Region::about(&centre, &half, &problem.parameters);
            Next::Move(region, worst.in_words(problem))
        })
    }

    /// The runs behind the surface of a model in a box.
    pub(crate) fn used(&self, surface: &Surface, region: &Region) -> Vec<&Sample> {
        let samples = self.samples.get(&surface.model);
        let done = samples.map_or(&[][..], |samples| &samples.done);
        let (inside, _) = of_regime(done, self.regime(surface.model));
        near(inside, &surface.parameters, region)
    }

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

    /// The regime that the surfaces of a model describe; empty where the simulator tells none.
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

/// The runs of the design of a model in a box, and those of its inputs, with the coarsest grains; parameters that are not active at
/// their start. Of finer grains a plane is sampled, so that the trend with the size is known all over the box.
pub(crate) fn design_runs(
    asked: Asked<'_>,
    first_seed: u64,
    (model, active): (usize, &[usize]),
    region: &Region,
) -> Result<Vec<Wanted>, Error> {
    let parameters = &asked.problem.parameters;
    let symbols = asked.problem.symbols(active);
    let design = surface_design(&symbols, asked.settings)?;
    let mut points = placed(&design.rows, active, region, parameters);
    let middle = placed(&[vec![0.0; active.len()]], active, region, parameters);
    let moved = middle.iter().flat_map(|at| input_points(asked, model, at));
    let times = asked.settings.replicates.max(1);
    points.extend(moved.flat_map(|at| std::iter::repeat_n(at, times)));
    let factors = asked.problem.factors_of(model);
    let mut runs = wanted(first_seed, (model, factors[0]), &points);
    for &finer in &factors[1..] {
        let rows = if active.is_empty() {
            vec![Vec::new(); FINER_AT_A_POINT]
        } else {
            slope_design(&symbols, asked.settings.seed)?
        };
        let points = placed(&rows, active, region, parameters);
        let points = points.into_iter();
        let points: Vec<_> = points
            .flat_map(|at| std::iter::repeat_n(at, times))
            .collect();
        let seed = first_seed + runs.len() as u64;
        runs.extend(wanted(seed, (model, finer), &points));
    }
    Ok(runs)
}

/// Points that tell how a model depends on its inputs: `at` with one of them at each end of its range.
pub(crate) fn input_points(asked: Asked<'_>, model: usize, at: &[f64]) -> Vec<Vec<f64>> {
    let moved = |j: usize| {
        let parameter = &asked.problem.parameters[j];
        let ends = parameter.range.into_iter();
        let ends = ends.filter(|end| *end != parameter.start);
        ends.map(move |end| {
            let mut at = at.to_vec();
            at[j] = end;
            at
        })
    };
    let inputs = asked.problem.inputs_of(model).into_iter();
    inputs.flat_map(moved).collect()
}

/// Coded rows as points of all parameters.
pub(crate) fn placed(
    rows: &[Vec<f64>],
    active: &[usize],
    region: &Region,
    parameters: &[crate::Parameter],
) -> Vec<Vec<f64>> {
    let start: Vec<f64> = parameters.iter().map(|p| p.start).collect();
    let point = |row: &Vec<f64>| {
        let mut at = start.clone();
        for (&j, x) in active.iter().zip(row) {
            at[j] = region.natural(j, *x);
        }
        at
    };
    rows.iter().map(point).collect()
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

/// How the whitened residuals change with parameter j, coded, while those that lie inside the box follow it: the part of its column
/// that theirs cannot imitate. Of two parameters that act alike one alone gains next to nothing beyond its face, and both together
/// much.
fn with_others(
    fit: &JointFit<'_>,
    jacobian: &DMatrix<f64>,
    best: &Minimum,
    j: usize,
) -> DVector<f64> {
    let follows = |k: &usize| *k != j && fit.free[*k] && best.coded[*k].abs() <= ON_THE_FACE;
    let others: Vec<usize> = (0..fit.parameters.len()).filter(follows).collect();
    let column = jacobian.column(j).into_owned();
    if others.is_empty() {
        return column;
    }
    let others = jacobian.select_columns(&others);
    let along = others.clone().svd(true, true).solve(&column, IMITATED);
    // Both sides of the decomposition are there, so that it can be solved.
    along.map_or_else(|_| column.clone(), |along| &column - others * along)
}

/// Whether a parameter acts on a measured observable beyond doubt.
pub(crate) fn acts(fit: &JointFit<'_>, j: usize, at: &[f64]) -> bool {
    let slope =
        |t: &crate::joint_fit::Target| fit.surfaces[t.surface].slope_in_errors(t.observable, j, at);
    fit.targets.iter().any(|t| slope(t).abs() > ACTS)
}
