//! The threshold between air and bed where the light is uneven.

use crate::pixels::to_f32;
use crate::view::DiscView;
use nalgebra::{SMatrix, SVector};
use surface_profile::median;

/// Number of terms: 1, x, y, x^2, x y, y^2.
const N_TERMS: usize = 6;
/// Weight of a flat light against the cells of a class: uneven light must show on more than a
/// few hundredths of the disc.
const FLATNESS: f64 = 0.004;
/// Rounds of sorting cells by the threshold and fitting the tones of the classes again.
const ROUNDS: usize = 4;
/// Cells looked at.
const MOST_CELLS: usize = 20_000;
/// The tones of air and bed never come nearer than this part of their mean difference.
const LEAST_PART: f64 = 0.4;
/// Cells farther than so many robust standard deviations from the tone of their class do not count.
const CUT_IN_SD: f64 = 3.0;
/// No cell nearer to the tone of its class than this part of the least difference is left out: an
/// eightieth of the contrast, the rounding of grey levels.
const LEAST_CUT: f64 = 0.03;

/// A tone that varies over the disc.
#[derive(Debug, Clone, Copy)]
struct Tone(SVector<f64, N_TERMS>);

/// The terms at a place in drum radii.
fn terms(x: f64, y: f64) -> SVector<f64, N_TERMS> {
    SVector::from([1.0, x, y, x * x, x * y, y * y])
}

impl Tone {
    /// Least squares with a penalty on everything but the mean.
    fn fit(cells: impl Iterator<Item = (f64, f64, f64)>) -> Option<Self> {
        let mut matrix = SMatrix::<f64, N_TERMS, N_TERMS>::zeros();
        let mut right = SVector::<f64, N_TERMS>::zeros();
        let mut n = 0.0;
        for (x, y, value) in cells {
            let row = terms(x, y);
            matrix += row * row.transpose();
            right += value * row;
            n += 1.0;
        }
        for k in 1..N_TERMS {
            matrix[(k, k)] += FLATNESS * n;
        }
        matrix.cholesky().map(|m| Self(m.solve(&right)))
    }

    /// The tone at a place in drum radii.
    fn at(&self, x: f64, y: f64) -> f64 {
        self.0.dot(&terms(x, y))
    }
}

/// Share of bed in each cell, 0 to 1, by its distance from the air tone (grey levels).
///
/// # Formula
/// Cells on either side of the threshold are two classes; the tone of each is a polynomial of
/// second degree over the disc (ridge least squares), low L and high H; the local threshold is
/// `(L + H) / 2`, and cells are sorted again by it, four times. From the second time on, cells farther
/// than 3 robust standard deviations from the tone of their class (a reflection, a stuck particle, an
/// object before the rim, the half tones of an edge) do not count for it. With a distance d the share is
/// `2 (d - L) / (H - L) - 1/2` between 0 and 1: the half share of a blurred edge lies where the
/// grey is half way, and a quarter of the way on either side is counted in full.
pub(crate) fn local_share(view: &DiscView, distance: &[f32], threshold: f64) -> Vec<f32> {
    let radius = view.radius();
    let place = |k: usize| {
        let (x, y) = view.position(k);
        (x / radius, y / radius)
    };
    let inside: Vec<usize> = (0..distance.len()).filter(|k| view.inside[*k]).collect();
    let stride = (inside.len() / MOST_CELLS).max(1);
    let cells: Vec<(f64, f64, f64)> = inside
        .iter()
        .step_by(stride)
        .map(|k| (place(*k).0, place(*k).1, f64::from(distance[*k])))
        .collect();
    let tones = class_tones(&cells, threshold);
    let mut share = vec![0.0_f32; distance.len()];
    for k in inside {
        let (x, y) = place(k);
        let d = f64::from(distance[k]);
        let value = match &tones {
            Some((low, high, least)) => {
                let low = low.at(x, y);
                2.0 * (d - low) / (high.at(x, y) - low).max(*least) - 0.5
            }
            None => d / threshold - 0.5,
        };
        share[k] = to_f32(value.clamp(0.0, 1.0));
    }
    share
}

/// Keeps the cells that lie near the tone of their class.
fn keep_near(cells: &mut Vec<(f64, f64, f64)>, tone: &Tone, least_cut: f64) {
    let off = |cell: &(f64, f64, f64)| (cell.2 - tone.at(cell.0, cell.1)).abs();
    let mut sizes: Vec<f64> = cells.iter().map(off).collect();
    let cut = (CUT_IN_SD * 1.4826 * median(&mut sizes)).max(least_cut);
    cells.retain(|cell| off(cell) <= cut);
}

/// Tones of the low and the high class, and their least difference.
fn class_tones(cells: &[(f64, f64, f64)], threshold: f64) -> Option<(Tone, Tone, f64)> {
    let mut tones: Option<(Tone, Tone, f64)> = None;
    for _ in 0..ROUNDS {
        let is_high = |x: f64, y: f64, d: f64| match &tones {
            None => d > threshold,
            Some((low, high, least)) => {
                let low = low.at(x, y);
                d > low + 0.5 * (high.at(x, y) - low).max(*least)
            }
        };
        let (mut high, mut low): (Vec<_>, Vec<_>) =
            cells.iter().partition(|(x, y, d)| is_high(*x, *y, *d));
        let mean = |cells: &[(f64, f64, f64)]| {
            cells.iter().map(|c| c.2).sum::<f64>() / cells.len().max(1) as f64
        };
        let least = LEAST_PART * (mean(&high) - mean(&low));
        if least.is_nan() || least <= 0.0 {
            return None;
        }
        if let Some((low_tone, high_tone, _)) = &tones {
            keep_near(&mut low, low_tone, LEAST_CUT * least);
            keep_near(&mut high, high_tone, LEAST_CUT * least);
        }
        tones = Some((
            Tone::fit(low.into_iter())?,
            Tone::fit(high.into_iter())?,
            least,
        ));
    }
    tones
}
