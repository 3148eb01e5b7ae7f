//! Finding the drum: edges and a robust circle; [`Rim`] refines it.

use crate::circle::{Circle, least_squares, through};
use crate::edges::{EdgePoint, find_edges};
use crate::rim::Rim;
use crate::{DrumPixels, PhotoPixels, PhotoReading, Refusal, RefusedReading};

/// The picture is searched at no more than this many pixels on its longer side.
const SEARCH_SIZE: usize = 400;
/// Triples of edge points tried. A rim that makes up a tenth of the edges is met 30 times.
const TRIALS: u32 = 30_000;
/// Circles scored at most; the edges on a clean rim alone would give thousands.
const MOST_SCORED: usize = 1000;
/// Of so many edge points one is looked at in the first scoring.
const SCORE_STRIDE: usize = 8;
/// Best circles of the first scoring that are looked at closely.
const POLISHED: usize = 10;
/// Steps round the circle in which an edge must show.
const N_STEPS: usize = 120;
/// How far an edge point may lie off the circle, px of the searched picture.
const NEAR: f64 = 1.2;
/// Least cosine between the edge normal and the radius: 25 degrees.
const ALONG_RADIUS: f64 = 0.906;
/// Smallest and largest radius, parts of the shorter and the longer side of the picture.
const RADIUS_LIMITS: [f64; 2] = [0.12, 0.6];
/// Least part of the circle that must show an edge: the bed's side alone, of a bed that fills a
/// sixth of a drum whose background has the tone of the air.
const LEAST_COVER: f64 = 0.25;
/// Least part of a circle that makes it worth a look if there is no drum: in grey noise edges show on 0.09 and less.
const LEAST_CANDIDATE: f64 = 0.15;
/// Largest flattening: 0.025 tilts an angle of 40 degrees by up to 0.7 degrees.
const MOST_FLATTENING: f64 = 0.025;

/// A drum found in a picture.
#[derive(Debug, Clone)]
pub(crate) struct FoundDrum {
    /// Its circle, px.
    pub(crate) circle: DrumPixels,
    /// How well its rim is known; none for a drum that the caller gave.
    pub(crate) rim: Option<Rim>,
}

/// Why no drum was found, and what came nearest to one.
#[derive(Debug, Clone)]
pub(crate) struct NotFound {
    pub(crate) reason: Refusal,
    /// The best circle; none if no part of a circle shows.
    pub(crate) candidate: Option<DrumPixels>,
}

impl NotFound {
    /// The refused reading.
    pub(crate) fn reading(self) -> PhotoReading {
        PhotoReading::Refused(RefusedReading {
            candidate: self.candidate,
            ..RefusedReading::new(self.reason, None)
        })
    }
}

/// Finds the circle of the drum.
pub(crate) fn find_drum(picture: &PhotoPixels) -> Result<FoundDrum, NotFound> {
    let longer = picture.width().max(picture.height());
    let factor = longer.div_ceil(SEARCH_SIZE).max(1);
    let edges = find_edges(&picture.shrunk(factor).blurred(std::f64::consts::SQRT_2));
    let no_drum = |covered, candidate| NotFound {
        reason: Refusal::NoDrum {
            covered,
            least: LEAST_COVER,
        },
        candidate,
    };
    let found = search(&edges, picture, factor).ok_or(no_drum(0.0, None))?;
    let scale = factor as f64;
    let shift = 0.5 * (scale - 1.0);
    let start = Circle {
        x: found.circle.x * scale + shift,
        y: found.circle.y * scale + shift,
        r: found.circle.r * scale,
    };
    let seen = Some(in_pixels(start)).filter(|_| found.covered >= LEAST_CANDIDATE);
    if found.covered < LEAST_COVER {
        return Err(no_drum(found.covered, seen));
    }
    let rim = Rim::find(picture, start, scale).ok_or(no_drum(found.covered, seen))?;
    if rim.shown < LEAST_COVER {
        let seen = seen.filter(|_| rim.shown >= LEAST_CANDIDATE);
        return Err(no_drum(rim.shown, seen));
    }
    let circle = in_pixels(rim.circle);
    let not_round = |reason| NotFound {
        reason,
        candidate: Some(circle),
    };
    if rim.is_broken() {
        return Err(not_round(Refusal::BrokenRim {
            shown: rim.shown,
            elsewhere: rim.elsewhere,
        }));
    }
    if rim.flattening > MOST_FLATTENING {
        return Err(not_round(Refusal::TiltedView {
            flattening: rim.flattening,
            most: MOST_FLATTENING,
        }));
    }
    Ok(FoundDrum {
        circle,
        rim: Some(rim),
    })
}

/// A circle as a caller gives it.
fn in_pixels(circle: Circle) -> DrumPixels {
    DrumPixels {
        cx: circle.x,
        cy: circle.y,
        r: circle.r,
    }
}

/// A circle and the part of its way round on which an edge shows.
#[derive(Debug, Clone, Copy)]
struct Found {
    /// The circle, px of the searched picture.
    circle: Circle,
    /// Part of the way round, 1.
    covered: f64,
}

/// Searches the circle with the longest way round on edges.
///
/// Triples are drawn by three additive recurrences with irrational steps (a fixed, evenly
/// spread sequence instead of chance). Of nearly equal concentric circles (a flange around the
/// window) the innermost one bounds the bed and is taken.
fn search(edges: &[EdgePoint], picture: &PhotoPixels, factor: usize) -> Option<Found> {
    if edges.len() < 30 {
        return None;
    }
    let (width, height) = (
        picture.width() as f64 / factor as f64,
        picture.height() as f64 / factor as f64,
    );
    let radii = RADIUS_LIMITS[0] * width.min(height)..=RADIUS_LIMITS[1] * width.max(height);
    let sample: Vec<EdgePoint> = edges.iter().step_by(SCORE_STRIDE).copied().collect();
    let mut all: Vec<Found> = Vec::new();
    for trial in 0..TRIALS {
        let pick = |step: f64| &edges[index(f64::from(trial + 1) * step, edges.len())];
        let (a, b, c) = (pick(PLASTIC[0]), pick(PLASTIC[1]), pick(PLASTIC[2]));
        let Some(circle) = through((a.x, a.y), (b.x, b.y), (c.x, c.y)) else {
            continue;
        };
        let sensible = radii.contains(&circle.r)
            && (0.0..width).contains(&circle.x)
            && (0.0..height).contains(&circle.y);
        if sensible && [a, b, c].iter().all(|p| radial(p, &circle)) {
            all.push(Found {
                circle,
                covered: covered(&sample, &circle),
            });
            if all.len() >= MOST_SCORED {
                break;
            }
        }
    }
    all.sort_by(|a, b| b.covered.total_cmp(&a.covered));
    all.truncate(POLISHED);
    for found in &mut all {
        found.covered = covered(edges, &found.circle);
        *found = polish(edges, *found);
    }
    let best = *all.iter().max_by(|a, b| a.covered.total_cmp(&b.covered))?;
    all.iter()
        .filter(|f| f.covered >= 0.85 * best.covered && f.circle.r >= 0.5 * best.circle.r)
        .filter(|f| {
            let off = (f.circle.x - best.circle.x).hypot(f.circle.y - best.circle.y);
            off < 0.1 * best.circle.r
        })
        .min_by(|a, b| a.circle.r.total_cmp(&b.circle.r))
        .copied()
}

/// Steps of the recurrences: powers of 1 / 1.2207, the root of x^4 = x + 1, whose multiples
/// fill the cube evenly.
const PLASTIC: [f64; 3] = [
    0.819_172_513_396_164_4,
    0.671_043_606_703_789_3,
    0.549_700_477_901_970_3,
];

/// Index below n from the fractional part of a number.
fn index(number: f64, n: usize) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the fractional part times n lies in 0..n"
    )]
    let index = (number.fract() * n as f64) as usize;
    index.min(n - 1)
}

/// Whether the edge at a point runs along the circle.
fn radial(point: &EdgePoint, circle: &Circle) -> bool {
    let (dx, dy) = (point.x - circle.x, point.y - circle.y);
    (dx * point.nx + dy * point.ny).powi(2) >= ALONG_RADIUS * ALONG_RADIUS * (dx * dx + dy * dy)
}

/// Edge points on the circle.
fn near<'a>(
    edges: &'a [EdgePoint],
    circle: &'a Circle,
) -> impl Iterator<Item = &'a EdgePoint> + 'a {
    let low = (circle.r - NEAR).max(0.0).powi(2);
    let high = (circle.r + NEAR).powi(2);
    edges.iter().filter(move |p| {
        let (dx, dy) = (p.x - circle.x, p.y - circle.y);
        (low..=high).contains(&(dx * dx + dy * dy)) && radial(p, circle)
    })
}

/// Part of the way round the circle on which an edge shows.
fn covered(edges: &[EdgePoint], circle: &Circle) -> f64 {
    let mut steps = [false; N_STEPS];
    for p in near(edges, circle) {
        let turn = (p.y - circle.y).atan2(p.x - circle.x) / std::f64::consts::TAU + 0.5;
        steps[index(turn, N_STEPS)] = true;
    }
    steps.iter().filter(|hit| **hit).count() as f64 / N_STEPS as f64
}

/// Moves a circle to the least squares of the edges near it, as long as that covers more.
fn polish(edges: &[EdgePoint], mut found: Found) -> Found {
    for _ in 0..5 {
        let points: Vec<(f64, f64)> = near(edges, &found.circle).map(|p| (p.x, p.y)).collect();
        let Some(circle) = least_squares(&points, found.circle) else {
            break;
        };
        let covered = covered(edges, &circle);
        if covered < found.covered {
            break;
        }
        found = Found { circle, covered };
    }
    found
}
