//! The angle of repose of a heap: both flanks, the apex and the base.

use crate::heap_flank::{HeapFlank, flank};
use crate::line::Line;
use crate::median::median;
use crate::{Error, SurfacePoint};

/// A flank is fitted between these fractions of the height: the foot spreads, the apex is round.
const FLANK: [f64; 2] = [0.2, 0.8];
/// An equally good choice; the change of the angle counts as one standard deviation.
const OTHER_FLANK: [f64; 2] = [0.25, 0.75];
/// A flank ends where the outline first comes below this part of the height.
const FOOT: f64 = 0.1;
/// The apex lies in the middle of the part above this fraction of the height.
const CROWN: f64 = 0.9;
/// Fewest points on a flank, and on the base beside it.
pub(crate) const FEWEST: usize = 12;
/// Least height of a heap, parts of the width of the outline.
const LEAST_HEIGHT: f64 = 0.05;
/// Width of a heap: where the outline first comes below this part of the height.
const FEET: f64 = 0.03;
/// No point nearer to the line of the base than this part of the height is left out.
const LEAST_CUT: f64 = 0.002;
/// Largest median distance of the base from its line, fractions of the height: a table is smoother.
const MOST_BASE_ROUGHNESS: f64 = 0.03;
/// The ends of an outline are this part of its points, on either side.
const END: f64 = 0.05;
/// Part of the height by which the outline of a heap never falls within [`WALL_RUN`]: the grains at its edge are smaller, also in a
/// heap of ten coarse ones, where a grain may hang over a gap.
const WALL_FALL: f64 = 0.35;
/// Run of a wall, parts of the height: with its fall 83 degrees.
const WALL_RUN: f64 = 0.04;

/// The flanks and the apex of a heap.
#[derive(Debug, Clone, PartialEq)]
pub struct HeapAngle {
    /// The flank at small x.
    pub left: HeapFlank,
    /// The flank at large x.
    pub right: HeapFlank,
    /// Where the lines of the flanks meet.
    pub apex: SurfacePoint,
    /// Distance of the heap below that point, unit of the points.
    pub rounding: f64,
    /// Height of the outline from foot to top, unit of the points.
    pub height: f64,
    /// Inclination of the base beside the heap, positive if it rises to the right, rad; `None` if the base is not visible
    /// on both sides.
    pub base: Option<f64>,
    /// Distance of the feet over that of the lines of the flanks at the same height, 1: less than 1 if the outline falls more
    /// steeply at its feet than on its flanks, like that of a cone seen from above. `None` if a foot is not visible.
    pub feet: Option<f64>,
    /// For each point given, whether it counts.
    pub used: Vec<bool>,
}

impl HeapAngle {
    /// Mean inclination of both flanks, rad. A tilted base or camera adds to one flank as much as it subtracts from the other.
    pub fn mean(&self) -> f64 {
        0.5 * (self.left.inclination + self.right.inclination)
    }

    /// Standard error of the mean inclination, rad: that of the two lines, or half of the difference of the flanks after correction for the
    /// tilt of the base, whichever is larger.
    ///
    /// # Formula
    /// Two values with a difference d have a mean with the standard error `|d| / 2`.
    pub fn standard_error(&self) -> f64 {
        let lines = 0.5 * self.left.standard_error.hypot(self.right.standard_error);
        let lean = self.base.unwrap_or(0.0);
        let difference = (self.left.inclination - lean) - (self.right.inclination + lean);
        lines.max(0.5 * difference.abs())
    }
}

/// Measures a heap by its outline, seen from the side.
///
/// # Formula
/// Height H: from the base to the 99 % quantile of the heights. The base is the line through what lies outside the feet
/// where that is straight on both sides, which may lean, and the 5 % quantile of the heights otherwise. Flank: the points from
/// the apex outwards to where the outline first comes below 0.1 H, of them those between 0.2 H and 0.8 H;
/// principal axis `[Pearson1901]`, outliers beyond 4 robust standard deviations set aside.
/// Standard error: `sqrt(s^2 tau / Suu)` as in [`crate::measure`] with two fitted parameters, and the
/// change of the inclination when the flank ends a twentieth of the height earlier on either side:
/// where a foot and a round top begin is a choice. The lower and the upper half of a flank have inclinations of their own.
///
/// # Errors
/// [`Error::NotFinitePoint`], [`Error::TooFewPoints`], [`Error::NoHeap`] for an outline without
/// height, with a flank that is missing, does not fall outwards, is a wall or ends in one, is curved like a ball or a spire, or
/// is too rough to be a line.
pub fn measure_heap(points: &[SurfacePoint]) -> Result<HeapAngle, Error> {
    measure_heap_above(points, FLANK[0])
}

/// [`measure_heap`] with the flanks fitted above a part of the height only: below, a camera that looks down sees the back of the
/// base. A part below 0.2 changes nothing.
///
/// # Errors
/// As [`measure_heap`].
pub fn measure_heap_above(points: &[SurfacePoint], part: f64) -> Result<HeapAngle, Error> {
    check(points)?;
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|a, b| points[*a].x.total_cmp(&points[*b].x));
    // What lies outside the feet may show a base that leans; the heap then stands on that.
    let over = |base: Base| Outline::over(points, &order, base);
    let beside = |base: Base| over(base).ok().and_then(|outline| outline.base_line());
    let level = Base::quantile(points);
    let base = beside(Base::between_ends(points, &order)).or_else(|| beside(level));
    let outline = over(base.unwrap_or(level))?;
    outline.check_walls()?;
    let mut used = vec![false; points.len()];
    let left = outline.flank(0, part, &mut used)?;
    let right = outline.flank(1, part, &mut used)?;
    let apex = meeting(&left, &right);
    Ok(HeapAngle {
        feet: outline.feet([&left, &right]),
        left,
        right,
        rounding: apex.y - outline.base.at(apex.x) - outline.height,
        apex,
        height: outline.height,
        base: base.map(|line| line.slope.atan()),
        used,
    })
}

/// Refuses points that are not finite, and too few.
fn check(points: &[SurfacePoint]) -> Result<(), Error> {
    let finite = |p: &SurfacePoint| p.x.is_finite() && p.y.is_finite();
    if let Some(index) = points.iter().position(|p| !finite(p)) {
        let SurfacePoint { x, y } = points[index];
        return Err(Error::NotFinitePoint { index, x, y });
    }
    let (n, least) = (points.len(), 4 * FEWEST);
    if n < least {
        return Err(Error::TooFewPoints { n, least });
    }
    Ok(())
}

/// The base of a heap.
#[derive(Debug, Clone, Copy)]
struct Base {
    /// Height at x = 0.
    height: f64,
    /// Rise over run.
    slope: f64,
}

impl Base {
    /// A level base at the 5 % quantile of the heights.
    fn quantile(points: &[SurfacePoint]) -> Self {
        let mut heights: Vec<f64> = points.iter().map(|p| p.y).collect();
        heights.sort_by(f64::total_cmp);
        Self {
            height: heights[heights.len() / 20],
            slope: 0.0,
        }
    }

    /// The line between the middles of the two ends of an outline.
    fn between_ends(points: &[SurfacePoint], order: &[usize]) -> Self {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a part of the number of points"
        )]
        let n = (END * order.len() as f64).ceil() as usize;
        let [left, right] = [&order[..n], &order[order.len() - n..]].map(|end| SurfacePoint {
            x: median(&mut end.iter().map(|k| points[*k].x).collect::<Vec<f64>>()),
            y: median(&mut end.iter().map(|k| points[*k].y).collect::<Vec<f64>>()),
        });
        let slope = (right.y - left.y) / (right.x - left.x).max(f64::MIN_POSITIVE);
        Self {
            height: left.y - slope * left.x,
            slope,
        }
    }

    /// Its height at a place.
    fn at(&self, x: f64) -> f64 {
        self.height + self.slope * x
    }
}

/// An outline over a base.
struct Outline<'a> {
    points: &'a [SurfacePoint],
    /// Their base.
    base: Base,
    /// Height of the top over it, unit of the points.
    height: f64,
    /// Points from the apex to the left, and to the right.
    outwards: [Vec<usize>; 2],
    /// How many of them lie before the foot.
    before_foot: [usize; 2],
}

impl<'a> Outline<'a> {
    /// Parts an outline at its apex and its feet; `order` is that of x.
    fn over(points: &'a [SurfacePoint], order: &[usize], base: Base) -> Result<Self, Error> {
        let over = |p: &SurfacePoint| p.y - base.at(p.x);
        let mut heights: Vec<f64> = points.iter().map(over).collect();
        heights.sort_by(f64::total_cmp);
        let height = heights[heights.len() * 99 / 100];
        let width = points[order[order.len() - 1]].x - points[order[0]].x;
        if height <= LEAST_HEIGHT * width {
            return Err(Error::NoHeap {
                what: "the outline is flat",
            });
        }
        let crown = points.iter().filter(|p| over(p) >= CROWN * height);
        let middle = median(&mut crown.map(|p| p.x).collect::<Vec<f64>>());
        let split = order.partition_point(|k| points[*k].x < middle);
        let outwards = [
            order[..split].iter().rev().copied().collect::<Vec<usize>>(),
            order[split..].to_vec(),
        ];
        let before_foot = [0, 1].map(|side: usize| {
            let foot = |k: &usize| over(&points[*k]) < FOOT * height;
            let outwards = &outwards[side];
            outwards.iter().position(foot).unwrap_or(outwards.len())
        });
        Ok(Self {
            points,
            base,
            height,
            outwards,
            before_foot,
        })
    }

    /// Height of a point over the base, parts of the height of the heap.
    fn level(&self, k: usize) -> f64 {
        (self.points[k].y - self.base.at(self.points[k].x)) / self.height
    }

    /// The line of the base beside the feet; `None` if too little of it is visible on a side, or if it is not straight.
    fn base_line(&self) -> Option<Base> {
        let [left, right] =
            [0, 1].map(|side: usize| &self.outwards[side][self.before_foot[side]..]);
        // A foot spreads over the base: what stands over the line is an outlier of it.
        let (line, base) = Line::near(self.points, [left, right].concat(), LEAST_CUT * self.height);
        let on_base = |side: &[usize]| side.iter().filter(|k| base.contains(k)).count();
        if on_base(left) < FEWEST || on_base(right) < FEWEST {
            return None;
        }
        let off = |k: &usize| line.off(&self.points[*k]).abs();
        let typical = median(&mut base.iter().map(off).collect::<Vec<f64>>());
        let slope = line.inclination.tan();
        (typical <= MOST_BASE_ROUGHNESS * self.height).then_some(Base {
            height: line.centre.y - slope * line.centre.x,
            slope,
        })
    }

    /// Refuses an outline that falls like a wall between apex and foot: a box, a beaker, or a heap that leans on one.
    fn check_walls(&self) -> Result<(), Error> {
        let [run, fall] = [WALL_RUN, WALL_FALL].map(|part| part * self.height);
        for (outwards, before) in self.outwards.iter().zip(self.before_foot) {
            // One point beyond the foot: a wall ends on it.
            let side = &outwards[..outwards.len().min(before + 1)];
            for (place, &k) in side.iter().enumerate() {
                let from = self.points[k];
                let near = |j: &&usize| (self.points[**j].x - from.x).abs() <= run;
                let next = side.get(place + 1).into_iter();
                let falls = |j: &usize| from.y - self.points[*j].y > fall;
                if side[place..].iter().take_while(near).chain(next).any(falls) {
                    return Err(Error::NoHeap {
                        what: "the outline falls like a wall",
                    });
                }
            }
        }
        Ok(())
    }

    /// Distance of the feet over that of the lines of both flanks there.
    fn feet(&self, flanks: [&HeapFlank; 2]) -> Option<f64> {
        // Where the outline comes down to the feet on one side, and where the line of the flank does.
        let places = |side: usize| {
            let is_foot = |k: &&usize| self.level(**k) < FEET;
            let foot = self.points[*self.outwards[side].iter().find(is_foot)?];
            let (flank, outwards) = (flanks[side], [-1.0, 1.0][side]);
            let from = flank.ends[0];
            let fall = from.y - self.base.at(foot.x) - FEET * self.height;
            Some([foot.x, from.x + outwards * fall / flank.inclination.tan()])
        };
        let (left, right) = (places(0)?, places(1)?);
        let [feet, lines] = [0, 1].map(|k: usize| right[k] - left[k]);
        (lines > 0.0).then(|| feet / lines)
    }

    /// Fits one flank above a part of the height, 0 for the left one.
    fn flank(&self, side: usize, part: f64, used: &mut [bool]) -> Result<HeapFlank, Error> {
        let raised = (part - FLANK[0]).max(0.0);
        let members = |[low, high]: [f64; 2]| -> Vec<usize> {
            let low = low + raised;
            let before_foot = &self.outwards[side][..self.before_foot[side]];
            let inside = |k: &usize| (low..=high).contains(&self.level(*k));
            before_foot.iter().copied().filter(inside).collect()
        };
        let place = ([-1.0, 1.0][side], self.height);
        let mut found = flank(self.points, members(FLANK), place, used)?;
        let mut aside = vec![false; self.points.len()];
        if let Ok(other) = flank(self.points, members(OTHER_FLANK), place, &mut aside) {
            let change = other.inclination - found.inclination;
            found.standard_error = found.standard_error.hypot(change);
        }
        Ok(found)
    }
}

/// Where the lines of a left and a right flank meet; both fall outwards, so they do.
fn meeting(left: &HeapFlank, right: &HeapFlank) -> SurfacePoint {
    let (a, b) = (left.inclination.tan(), -right.inclination.tan());
    let (p, q) = (left.ends[0], right.ends[0]);
    let x = (q.y - p.y + a * p.x - b * q.x) / (a - b);
    SurfacePoint {
        x,
        y: p.y + a * (x - p.x),
    }
}

#[cfg(test)]
mod tests {
    use super::measure_heap;
    use crate::{Error, SurfacePoint};

    /// A heap with flanks of 30 and 40 degrees and its apex at (0, 100) on a base at height 0.
    fn outline() -> Vec<SurfacePoint> {
        (-300..=300)
            .map(|k| {
                let x = f64::from(k);
                let slope = if x < 0.0 { 30.0_f64 } else { 40.0 };
                let y = (100.0 - x.abs() * slope.to_radians().tan()).max(0.0);
                SurfacePoint { x, y }
            })
            .collect()
    }

    /// Exact lines come back to rounding.
    #[test]
    fn both_flanks_and_the_apex_of_an_exact_heap_come_back() {
        let heap = measure_heap(&outline()).unwrap();
        assert!(
            (heap.left.inclination.to_degrees() - 30.0).abs() < 1e-9,
            "{heap:?}"
        );
        assert!(
            (heap.right.inclination.to_degrees() - 40.0).abs() < 1e-9,
            "{heap:?}"
        );
        assert!(heap.apex.x.abs() < 1e-9 && (heap.apex.y - 100.0).abs() < 1e-9);
    }

    /// A grain stuck on one flank over a tenth of its length is set aside.
    #[test]
    fn a_stuck_grain_does_not_turn_a_flank() {
        let mut points = outline();
        for p in points.iter_mut().filter(|p| (-90.0..-80.0).contains(&p.x)) {
            p.y += 12.0;
        }
        let heap = measure_heap(&points).unwrap();
        assert!(
            (heap.left.inclination.to_degrees() - 30.0).abs() < 1e-6,
            "{heap:?}"
        );
    }

    /// The same outline on a base that leans by 5 degrees, as under a camera that does: the lean comes back (to 0.01
    /// degrees: a point of each foot lies nearer to the base than what is left out), one flank has it
    /// more and the other less, and the mean stays.
    #[test]
    fn a_leaning_base_turns_both_flanks_and_not_their_mean() {
        let lean = 5.0_f64.to_radians();
        let mut points = outline();
        for p in &mut points {
            let (x, y) = (p.x, p.y);
            p.x = x * lean.cos() - y * lean.sin();
            p.y = x * lean.sin() + y * lean.cos();
        }
        let heap = measure_heap(&points).unwrap();
        assert!((heap.base.unwrap() - lean).abs() < 2e-4, "{heap:?}");
        assert!(
            (heap.left.inclination.to_degrees() - 35.0).abs() < 1e-9,
            "{heap:?}"
        );
        assert!(
            (heap.right.inclination.to_degrees() - 35.0).abs() < 1e-9,
            "{heap:?}"
        );
    }

    /// Flanks of 30 and 40 degrees have a mean that is known to 5: each may be the angle of repose.
    #[test]
    fn flanks_that_differ_widen_the_interval_of_their_mean() {
        let heap = measure_heap(&outline()).unwrap();
        assert!(
            (heap.standard_error().to_degrees() - 5.0).abs() < 0.01,
            "{heap:?}"
        );
    }

    /// A foot that spreads: the flanks fall by 40 degrees down to 0.5 of the height and by 20 below. Top and toe tell both; the
    /// halves of the flank share no slope, so that each is exact but for the point at the break.
    #[test]
    fn a_spread_foot_is_told_by_toe_and_top() {
        let slopes = [40.0_f64, 20.0].map(|d| d.to_radians().tan());
        let run = 50.0 / slopes[0];
        let points: Vec<SurfacePoint> = (-600..=600)
            .map(|k| {
                let x = f64::from(k) * 0.5;
                let beyond = (x.abs() - run).max(0.0);
                let y = 100.0 - slopes[0] * x.abs().min(run) - slopes[1] * beyond;
                SurfacePoint { x, y: y.max(0.0) }
            })
            .collect();
        let heap = measure_heap(&points).unwrap();
        for flank in [heap.left, heap.right] {
            let (top, toe) = (flank.top.to_degrees(), flank.toe.to_degrees());
            assert!((toe - 20.0).abs() < 0.1, "toe {toe}");
            assert!(top > 30.0 && top < 40.0, "top {top}");
            assert!(flank.inclination.to_degrees() > 22.0, "{flank:?}");
        }
    }

    /// Discs of a sixth of the height lie along flanks of 30 degrees, one in four is missing: at the gaps the outline falls steeply to
    /// the grains behind, by more than a fifth of the height. Both flanks hold 30 degrees within their 95 % intervals.
    #[test]
    fn a_heap_of_coarse_grains_is_a_heap() {
        let (height, radius) = (140.0, 11.0);
        let slope = 30.0_f64.to_radians();
        let along = |k: u32| 1.8 * radius * f64::from(k);
        let centres: Vec<[f64; 2]> = (0..14)
            .filter(|k| k % 4 != 2)
            .map(|k| {
                [
                    along(k) * slope.cos(),
                    height - along(k) * slope.sin() - radius,
                ]
            })
            .collect();
        let top = |x: f64| {
            let over = centres.iter().map(|[at, level]| {
                let under = radius.powi(2) - (x.abs() - at).powi(2);
                if under > 0.0 {
                    level + under.sqrt()
                } else {
                    0.0
                }
            });
            let behind = height - 2.5 * radius - x.abs() * slope.tan();
            over.fold(behind.max(0.0), f64::max)
        };
        let points: Vec<SurfacePoint> = (-600..=600)
            .map(|k| f64::from(k) * 0.5)
            .map(|x| SurfacePoint { x, y: top(x) })
            .collect();
        let heap = measure_heap(&points).unwrap();
        for flank in [heap.left, heap.right] {
            let off = flank.inclination - slope;
            assert!(off.abs() < 1.96 * flank.standard_error, "{off}");
        }
    }

    /// A cube seen over an edge: two slopes of 30 degrees, and walls below them.
    #[test]
    fn slopes_that_end_in_walls_are_no_heap() {
        let cube: Vec<SurfacePoint> = (-400..=400)
            .map(|k| {
                let x = f64::from(k);
                let top = 240.0 - x.abs() * 30.0_f64.to_radians().tan();
                let y = if x.abs() <= 200.0 { top } else { 0.0 };
                SurfacePoint { x, y }
            })
            .collect();
        let error = measure_heap(&cube).unwrap_err();
        assert!(error.to_string().contains("wall"), "{error}");
    }

    /// The upper half of a circle rises to 90 degrees at its ends.
    #[test]
    fn the_outline_of_a_ball_is_no_heap() {
        let ball: Vec<SurfacePoint> = (-300..=300)
            .map(|k| {
                let x = f64::from(k);
                let y = (200.0_f64.powi(2) - x * x).max(0.0).sqrt();
                SurfacePoint { x, y }
            })
            .collect();
        assert!(matches!(measure_heap(&ball), Err(Error::NoHeap { .. })));
    }

    #[test]
    fn what_is_no_heap_is_refused() {
        let flat: Vec<SurfacePoint> = outline()
            .iter()
            .map(|p| SurfacePoint {
                x: p.x,
                y: 0.01 * p.y,
            })
            .collect();
        let half: Vec<SurfacePoint> = outline().into_iter().filter(|p| p.x >= 0.0).collect();
        for points in [flat, half] {
            assert!(matches!(measure_heap(&points), Err(Error::NoHeap { .. })));
        }
        assert!(measure_heap(&outline()[..20]).is_err(), "too few points");
        let mut bad = outline();
        bad[3].y = f64::NAN;
        assert!(measure_heap(&bad).is_err(), "NaN");
    }
}
