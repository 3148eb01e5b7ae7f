//! The rim of a drum at full resolution: its circle, and how well it is known.

use crate::circle::{Circle, least_squares};
use crate::rays::{N_RAYS, Rays, RimPoint};
use crate::{PhotoPixels, PixelPoint};
use nalgebra::{SMatrix, SVector};
use surface_profile::median;

/// The rim shows on a ray where an edge lies within this part of the radius from it.
const ON_RIM: f64 = 0.01;
/// A strip whose tones spread by less than this part of those inside it is a solid rim.
const ONE_TONE: f64 = 0.4;
/// Edges are looked for within this part of the radius on either side.
const WINDOW: f64 = 0.12;
/// A ring within the window is preferred to a better one outside it from this part of the
/// better one's support on: a flange shows two edges all round, and the inner one holds the bed.
const INNER_SUPPORT: f64 = 0.75;
/// A ring with this part of the support is preferred all the same where the strip between has one
/// tone: the inner edge of a solid rim of the tone of the bed shows along the air only.
const SOLID_SUPPORT: f64 = 0.4;
/// A ring with this part of the support may be the true one and enters the uncertainty.
const RIVAL_SUPPORT: f64 = 0.25;
/// Both edges of a thin rim are looked for within this part of the radius on either side.
const THIN_WINDOW: f64 = 0.035;
/// A rim thinner than this part of the radius is a line.
const THINNEST: f64 = 0.006;
/// A thin rim shows both edges at one distance on so many rays.
const BOTH_EDGES: usize = N_RAYS / 4;
/// From this part of the turn on the rim is whole, hidden only here and there.
const WHOLE: f64 = 0.7;
/// From this part of the turn on the flattening is known well enough to tell an ellipse.
const HALF: f64 = 0.5;
/// Most of the turn that may show an edge beside a rim that is not whole. The end of an ellipse
/// is near a circle, and its sides run off it.
const MOST_ELSEWHERE: f64 = 0.2;
/// Most of the turn that may show an edge beside a rim that shows on more than half: a solid rim has two
/// edges, and a circle can follow the inner one at the sides of an ellipse and the outer one above and
/// below.
const MOST_BESIDE_WHOLE: f64 = 0.3;
/// Flattening of the ellipse through edges far from the circle above which edges beside it are those of an
/// ellipse: 0.054 and more in drawn views of tilted drums, 0.036 in an oblique photo, 0.026 and less in
/// drawn pictures of other kinds.
const MOST_WIDE: f64 = 0.03;
/// Below this part of the turn too little of the rim shows to tell an ellipse.
const SCARCE: f64 = 0.36;

/// The ellipse is looked for within this part of the radius from the circle.
const ELLIPSE_WINDOW: f64 = 0.035;
/// A circle through fewer rays than this is not refined further.
const FEWEST_POINTS: usize = 40;
/// Least part of the rim that must show along the bed or along the air.
const LEAST_ALONG_ARC: f64 = 0.75;

/// The rim at full resolution.
#[derive(Debug, Clone)]
pub(crate) struct Rim {
    /// The circle, px.
    pub(crate) circle: Circle,
    /// Standard error of its place and radius, px.
    pub(crate) error: f64,
    /// Distance to a rival ring, 0 for none, px.
    pub(crate) rival: f64,
    /// 1 minus the ratio of the axes of the ellipse nearest to the rim, 1.
    pub(crate) flattening: f64,
    /// The same with edges up to [`WINDOW`] away.
    wide: f64,
    /// For each ray, from right over down, whether an edge lies on the circle.
    shows: Vec<bool>,
    /// Part of the turn on which an edge lies on the circle, 1.
    pub(crate) shown: f64,
    /// Part of the turn on which an edge lies beside the circle only, 1.
    pub(crate) elsewhere: f64,
}

impl Rim {
    /// Refines a circle: the ring of edges nearest to it, then robust least squares.
    ///
    /// `scale` is how many pixels the start may be off.
    pub(crate) fn find(picture: &PhotoPixels, start: Circle, scale: f64) -> Option<Self> {
        let Ring {
            start,
            outer,
            rival,
            width,
        } = choose_ring(picture, start);
        let (circle, kept) = refine(picture, start, scale, width)?;
        let (circle, kept, outer) = inner_edge(picture, &circle).unwrap_or((circle, kept, outer));
        let rays = Rays::scan(picture, &circle, WINDOW * circle.r);
        let near = (ON_RIM * circle.r).max(1.5).max(0.3 * rays.edge_width());
        let weakest = rays.weakest(near);
        let mut shows = vec![false; N_RAYS];
        let mut elsewhere = 0.0;
        for (ray, shows) in shows.iter_mut().enumerate() {
            let edges = rays.edges(ray, weakest);
            *shows = edges
                .iter()
                .any(|off| off.abs() <= near || (off - outer).abs() <= near);
            if !*shows && !edges.is_empty() {
                elsewhere += 1.0 / N_RAYS as f64;
            }
        }
        let shown = shows.iter().filter(|s| **s).count() as f64 / N_RAYS as f64;
        let scatter = kept.iter().map(|p| p.off(&circle).powi(2)).sum::<f64>() / kept.len() as f64;
        // Neighbouring rays overlap by about RAY_WIDTH; four points of each count once.
        let independent = (kept.len() as f64 / 4.0).max(1.0);
        Some(Self {
            circle,
            error: (2.0 * scatter / independent).sqrt().max(0.05),
            rival,
            flattening: flattening(
                picture,
                &circle,
                (ELLIPSE_WINDOW * circle.r).max(0.7 * width),
            ),
            wide: flattening(picture, &circle, WINDOW * circle.r),
            shows,
            shown,
            elsewhere,
        })
    }

    /// Whether edges run off the circle as those of an ellipse do.
    pub(crate) fn is_broken(&self) -> bool {
        let beside = self.shown < HALF && self.elsewhere > MOST_ELSEWHERE
            || self.shown < WHOLE && self.elsewhere > MOST_BESIDE_WHOLE;
        // Noise and a bed that curls up at the wall leave edges beside the rim as well, but no ellipse.
        beside && (self.wide > MOST_WIDE || self.shown < SCARCE)
    }

    /// Whether a rim that shows in part only hides elsewhere than along the bed or along the air.
    ///
    /// A background of the tone of the air hides the rim along the air, one of the tone of the
    /// bed along the bed; a circle that hides along both is not the drum. `ends` are where the
    /// surface meets the circle, px. An arc shorter than a tenth of the turn does not count.
    pub(crate) fn hides_oddly(&self, ends: [PixelPoint; 2]) -> bool {
        let turn = |p: PixelPoint| {
            let turn = (p.y - self.circle.y).atan2(p.x - self.circle.x) / std::f64::consts::TAU;
            turn.rem_euclid(1.0)
        };
        let (from, to) = (turn(ends[0]), turn(ends[1]));
        let mut counts = [[0.0_f64; 2]; 2];
        for (ray, shows) in self.shows.iter().enumerate() {
            let place = (ray as f64 + 0.5) / N_RAYS as f64;
            let arc = usize::from((place - from).rem_euclid(1.0) < (to - from).rem_euclid(1.0));
            counts[arc][0] += 1.0;
            counts[arc][1] += f64::from(u8::from(*shows));
        }
        let most = counts
            .iter()
            .filter(|c| c[0] >= 0.1 * N_RAYS as f64)
            .map(|c| c[1] / c[0])
            .fold(0.0, f64::max);
        self.shown < WHOLE && most < LEAST_ALONG_ARC
    }
}

/// A ring of edges.
struct Ring {
    /// Its circle, px.
    start: Circle,
    /// Distance to the outer edge of a solid rim, 0 for none, px.
    outer: f64,
    /// Distance to a rival ring, 0 for none, px.
    rival: f64,
    /// Width of its edges, px.
    width: f64,
}

/// Moves the circle to the ring of edges that bounds the bed, and shows how far a rival is.
///
/// The support of a radius is the part of the turn with an edge within [`ON_RIM`] of it.
fn choose_ring(picture: &PhotoPixels, start: Circle) -> Ring {
    let rays = Rays::scan(picture, &start, WINDOW * start.r);
    let near = (ON_RIM * start.r).max(1.5);
    let weakest = rays.weakest(2.0 * near);
    let edges: Vec<Vec<f64>> = (0..N_RAYS).map(|ray| rays.edges(ray, weakest)).collect();
    let support = |off: f64| {
        let hit = |edges: &&Vec<f64>| edges.iter().any(|e| (e - off).abs() <= near);
        edges.iter().filter(hit).count() as f64 / N_RAYS as f64
    };
    let n = (WINDOW * start.r / (0.5 * near)).floor();
    let mut rings = Vec::new();
    let mut k = -n;
    while k <= n {
        let off = k * 0.5 * near;
        rings.push((off, support(off)));
        k += 1.0;
    }
    let best = rings.iter().map(|r| r.1).fold(0.0, f64::max);
    let tops: Vec<(f64, f64)> = (1..rings.len().saturating_sub(1))
        .filter(|i| rings[*i].1 >= rings[i - 1].1 && rings[*i].1 > rings[i + 1].1)
        .map(|i| rings[i])
        .collect();
    let strongest = tops
        .iter()
        .find(|top| top.1 >= best)
        .map_or(0.0, |top| top.0);
    let inner = tops.iter().find(|top| {
        top.1 >= INNER_SUPPORT * best
            || best >= WHOLE
                && top.1 >= SOLID_SUPPORT * best
                && top.0 + 2.0 * near < strongest
                && is_one_tone(picture, &start, top.0, strongest, near)
    });
    let off = inner.map_or(0.0, |top| top.0);
    let rival = tops
        .iter()
        .filter(|top| top.1 >= RIVAL_SUPPORT * best && (top.0 - off).abs() > 2.0 * near)
        .map(|top| (top.0 - off).abs())
        .fold(f64::INFINITY, f64::min);
    Ring {
        start: Circle {
            r: start.r + off,
            ..start
        },
        outer: if best >= WHOLE {
            f64::max(strongest - off, 0.0)
        } else {
            0.0
        },
        rival: if rival.is_finite() { rival } else { 0.0 },
        width: rays.edge_width(),
    }
}

/// Whether the strip between two rings has one tone all round, as a solid rim has; what is seen
/// through a window shows bed on one side and air on the other.
fn is_one_tone(picture: &PhotoPixels, start: &Circle, low: f64, high: f64, near: f64) -> bool {
    let spread = |off: f64| {
        let r = start.r + off;
        let mut tones: Vec<f64> = (0..N_RAYS)
            .map(|ray| std::f64::consts::TAU * (ray as f64 + 0.5) / N_RAYS as f64)
            .map(|turn| picture.at(start.x + r * turn.cos(), start.y + r * turn.sin()))
            .collect();
        tones.sort_by(f64::total_cmp);
        tones[N_RAYS * 9 / 10] - tones[N_RAYS / 10]
    };
    spread(0.5 * (low + high)) < ONE_TONE * spread(low - 3.0 * near)
}

/// The steepest grey steps near the circle and the robust least-squares circle through them.
fn refine(
    picture: &PhotoPixels,
    start: Circle,
    scale: f64,
    width: f64,
) -> Option<(Circle, Vec<RimPoint>)> {
    let mut circle = start;
    let mut kept = Vec::new();
    for pass in 0..4 {
        let window = match pass {
            0 => (0.03 * start.r).max(2.0 * scale),
            _ => (0.015 * start.r).max(2.0),
        }
        .max(0.7 * width);
        let found = Rays::scan(picture, &circle, window).steepest();
        if found.len() < FEWEST_POINTS {
            break;
        }
        kept = found;
        for _ in 0..4 {
            let points: Vec<(f64, f64)> = kept.iter().map(|p| (p.x, p.y)).collect();
            circle = least_squares(&points, circle)?;
            let mut sizes: Vec<f64> = kept.iter().map(|p| p.off(&circle).abs()).collect();
            let cut = (4.0 * 1.4826 * median(&mut sizes)).max(0.5);
            kept.retain(|p| p.off(&circle).abs() <= cut);
        }
    }
    (!kept.is_empty()).then_some((circle, kept))
}

/// The inner edge of a thin solid rim; none if the rim is not one.
///
/// Along the air both edges of such a rim show, along a bed of its tone the outer one only, and a circle through the
/// steepest steps follows the inner edge here and the outer one there. Where enough rays show two edges at one distance,
/// the outer one is fitted all round, and the circle lies inside it by that distance. Points are those of the outer edge,
/// moved inwards; the distance (px) comes last.
fn inner_edge(picture: &PhotoPixels, start: &Circle) -> Option<(Circle, Vec<RimPoint>, f64)> {
    let rays = Rays::scan(picture, start, THIN_WINDOW * start.r);
    let weakest = rays.weakest(ON_RIM * start.r);
    let edges: Vec<Vec<f64>> = (0..N_RAYS).map(|ray| rays.edges(ray, weakest)).collect();
    let mut gaps: Vec<f64> = edges
        .iter()
        .filter_map(|of_ray| match of_ray[..] {
            [.., inner, outer] => Some(outer - inner),
            _ => None,
        })
        .collect();
    if gaps.is_empty() {
        return None;
    }
    let all = gaps.clone();
    let gap = median(&mut gaps);
    let alike = all
        .iter()
        .filter(|g| (*g - gap).abs() <= (0.2 * gap).max(1.0));
    if alike.count() < BOTH_EDGES || gap < THINNEST * start.r {
        return None;
    }
    let outer = edges.iter().enumerate().filter_map(|(ray, of_ray)| {
        let r = start.r + of_ray.last()?;
        let (sin, cos) = (std::f64::consts::TAU * (ray as f64 + 0.5) / N_RAYS as f64).sin_cos();
        Some((start.x + r * cos, start.y + r * sin))
    });
    let mut points: Vec<(f64, f64)> = outer.collect();
    let mut circle = *start;
    for _ in 0..4 {
        circle = least_squares(&points, circle)?;
        let off = |p: &(f64, f64)| ((p.0 - circle.x).hypot(p.1 - circle.y) - circle.r).abs();
        let mut sizes: Vec<f64> = points.iter().map(off).collect();
        let cut = (4.0 * 1.4826 * median(&mut sizes)).max(0.5);
        points.retain(|p| off(p) <= cut);
    }
    if (points.len() as f64) < WHOLE * N_RAYS as f64 {
        return None;
    }
    let share = (circle.r - gap) / circle.r;
    let inwards = |p: &(f64, f64)| RimPoint {
        x: circle.x + (p.0 - circle.x) * share,
        y: circle.y + (p.1 - circle.y) * share,
    };
    let kept = points.iter().map(inwards).collect();
    let r = circle.r - gap;
    Some((Circle { r, ..circle }, kept, gap))
}

/// Flattening of the ellipse nearest to the rim.
///
/// # Formula
/// `d = a0 + a1 cos phi + b1 sin phi + a2 cos 2 phi + b2 sin 2 phi` by least squares on the
/// distances d of the steepest steps from the circle, outliers cut; the flattening is
/// `2 sqrt(a2^2 + b2^2) / r`, exact to first order.
fn flattening(picture: &PhotoPixels, circle: &Circle, window: f64) -> f64 {
    let mut points = Rays::scan(picture, circle, window).steepest();
    let row = |p: &RimPoint| {
        let turn = (p.y - circle.y).atan2(p.x - circle.x);
        let (s1, c1) = turn.sin_cos();
        let (s2, c2) = (2.0 * turn).sin_cos();
        SVector::<f64, 5>::new(1.0, c1, s1, c2, s2)
    };
    let mut fitted = SVector::<f64, 5>::zeros();
    for _ in 0..8 {
        let mut matrix = SMatrix::<f64, 5, 5>::zeros();
        let mut right = SVector::<f64, 5>::zeros();
        for p in &points {
            matrix += row(p) * row(p).transpose();
            right += p.off(circle) * row(p);
        }
        let Some(inverse) = matrix.cholesky() else {
            break;
        };
        fitted = inverse.solve(&right);
        let rest = |p: &RimPoint| (p.off(circle) - fitted.dot(&row(p))).abs();
        let mut sizes: Vec<f64> = points.iter().map(rest).collect();
        let cut = (3.0 * 1.4826 * median(&mut sizes)).max(0.5);
        points.retain(|p| rest(p) <= cut);
    }
    2.0 * fitted[3].hypot(fitted[4]) / circle.r
}
