//! The next box of a search: beyond a face, or a smaller one.

use super::{Found, Search};
use crate::Error;
use crate::intervals::best_of;
use crate::joint_fit::{JointFit, Minimum};
use crate::lack_of_fit::{Missed, missed};
use crate::region::Region;
use crate::samples::{Samples, of_regime};
use input::quantity::significant;
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// A coordinate so near to 1 lies on the face of the box.
const ON_THE_FACE: f64 = 0.999;
/// Slope over its standard error from which a parameter counts as acting on an observable.
const ACTS: f64 = 3.0;
/// Fall of Q behind the face that is worth a new box: 0.05 is a fifth of a standard error.
const WORTH: f64 = 0.05;
/// Singular values below this are those of columns that do nothing.
const IMITATED: f64 = 1e-12;
/// Least and largest way from a face to the middle of the next box, in half widths.
const WAY: [f64; 2] = [0.25, 2.0];
/// Width of the next box over that of one whose surfaces miss their runs.
const NEARER: f64 = 0.4;

/// Where the search goes from a box.
pub(super) enum Next {
    /// Nowhere: the best point lies inside or nothing is to be gained beyond, and the surfaces meet their runs.
    Stay,
    /// To another box, with the reason.
    Move(Region, String),
}

impl Search<'_> {
    /// Where the search goes from a box.
    ///
    /// The box moves along every parameter whose face holds the best point back from a lower misfit, if the parameter
    /// acts on a measured observable beyond doubt: the slope of a dead one is noise. It moves as far as the plane
    /// through the best point says, and grows with the way.
    pub(super) fn next(&self, found: &Found) -> Result<Next, Error> {
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

    /// A smaller box about the best point, along the parameters of the surfaces that miss their runs; nowhere if none does.
    ///
    /// What is curved otherwise than a polynomial is less so in a smaller box. But there slopes are known less well: along a
    /// parameter whose slope would no longer stand out of its noise the box stays.
    pub(super) fn smaller(&self, found: &Found, fresh: &BTreeMap<usize, Samples>) -> Next {
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
