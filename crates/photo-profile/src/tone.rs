//! Which grey level is air, and how much of each cell is bed.

use crate::light::local_share;
use crate::pixels::to_f32;
use crate::view::{DiscView, REACH};
use crate::{Foreground, Refusal, otsu_threshold};
use surface_profile::median;

/// Classes of grey level for the search of the cut.
const N_CLASSES: usize = 16;
/// Directions tried between -80 and 80 degrees from the horizontal, one each 5 degrees.
const N_DIRECTIONS: u32 = 33;
/// Steps of the offset across the drum, one each 0.05 radii.
const N_OFFSETS: usize = 40;
/// Cells looked at in the search of the cut.
const SEARCH_CELLS: usize = 6000;
/// Least difference of the tones of bed and air, grey levels of 255.
const LEAST_DIFFERENCE: f64 = 6.0;
/// From this share on, bed that is darker (or brighter) than the air is taken for the only one.
const ONE_SIDED: f64 = 0.9;

/// How much of each cell is bed.
#[derive(Debug)]
pub(crate) struct BedShare {
    /// 0 for air, 1 for bed, shape as the view.
    pub(crate) share: Vec<f32>,
    /// The same by one threshold for all: a light that fades over an empty drum makes no edge in
    /// it, as it may make where the threshold follows the light.
    pub(crate) plain: Vec<f32>,
    /// The tone that was taken for bed.
    pub(crate) foreground: Foreground,
}

impl BedShare {
    /// The plain share of the cell nearest to a place about the axis (y up, px); 0 outside.
    pub(crate) fn plain_at(&self, view: &DiscView, x: f64, y: f64) -> f64 {
        let half = (view.n / 2) as f64;
        let (i, j) = (
            (x / view.cell + half).round(),
            (y / view.cell + half).round(),
        );
        let last = view.n as f64 - 1.0;
        if !((0.0..=last).contains(&i) && (0.0..=last).contains(&j)) {
            return 0.0;
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "whole numbers on the grid"
        )]
        let k = j as usize * view.n + i as usize;
        f64::from(self.plain[k])
    }
}

/// Separates bed from air.
///
/// The air is the upper side of the straight cut that tells most about the grey level. Its
/// median grey is the air tone; a cell is bed by its distance from that tone. The threshold is
/// that of [`otsu_threshold`], made local by [`local_share`].
pub(crate) fn bed_share(view: &DiscView, foreground: Foreground) -> Result<BedShare, Refusal> {
    let gray = view.gray.values();
    let sides = straight_sides(view, gray).ok_or(Refusal::OneTone { difference: 0.0 })?;
    let levels = |cells: &[usize]| -> Vec<f32> { cells.iter().map(|k| gray[*k]).collect() };
    let (air, bed) = (levels(&sides.above), levels(&sides.below));
    if air.is_empty() || bed.is_empty() {
        return Err(Refusal::OneTone { difference: 0.0 });
    }
    let parted = part(gray, &view.inside, &air, &bed, foreground)?;
    Ok(BedShare {
        share: local_share(view, &parted.distance, parted.threshold),
        plain: parted.plain(),
        foreground: parted.foreground,
    })
}

/// Separates a heap from the air above it, whose tone the first `n_sky` cells show.
pub(crate) fn air_and_bed(
    gray: &[f32],
    n_sky: usize,
    foreground: Foreground,
) -> Result<BedShare, Refusal> {
    let (sky, rest) = gray.split_at(n_sky.min(gray.len()));
    if sky.is_empty() || rest.is_empty() {
        return Err(Refusal::OneTone { difference: 0.0 });
    }
    let parted = part(gray, &vec![true; gray.len()], sky, rest, foreground)?;
    let plain = parted.plain();
    Ok(BedShare {
        share: plain.clone(),
        plain,
        foreground: parted.foreground,
    })
}

/// Cells sorted by their distance from the air tone.
struct Parted {
    /// Distance of each cell from the air tone, grey levels.
    distance: Vec<f32>,
    /// Threshold between air and bed, grey levels.
    threshold: f64,
    /// The tone that was taken for bed.
    foreground: Foreground,
}

impl Parted {
    /// Share of bed by the one threshold: 0 at half of it, 1 at one and a half.
    fn plain(&self) -> Vec<f32> {
        let share = |d: &f32| to_f32((f64::from(*d) / self.threshold - 0.5).clamp(0.0, 1.0));
        self.distance.iter().map(share).collect()
    }
}

/// Takes the median of the air for its tone and parts the cells by their distance from it.
fn part(
    gray: &[f32],
    inside: &[bool],
    air: &[f32],
    bed: &[f32],
    foreground: Foreground,
) -> Result<Parted, Refusal> {
    let mut air: Vec<f64> = air.iter().map(|v| f64::from(*v)).collect();
    let air_tone = to_f32(median(&mut air));
    let foreground = match foreground {
        Foreground::Auto => {
            let distance = distances(gray, air_tone, Foreground::Auto);
            polarity(bed, air_tone, threshold(inside, &distance)?)
        }
        given => given,
    };
    let distance = distances(gray, air_tone, foreground);
    let threshold = threshold(inside, &distance)?;
    if 2.0 * threshold < LEAST_DIFFERENCE {
        return Err(Refusal::OneTone {
            difference: 2.0 * threshold,
        });
    }
    Ok(Parted {
        distance,
        threshold,
        foreground,
    })
}

/// Distance of each grey level from the air tone, positive on the side of the foreground.
///
/// It keeps its sign where the side is known: air in uneven light lies on either side of its median,
/// and folded over it would have no smooth tone.
fn distances(gray: &[f32], air_tone: f32, foreground: Foreground) -> Vec<f32> {
    let signed = gray.iter().map(|g| g - air_tone);
    match foreground {
        Foreground::Auto => signed.map(f32::abs).collect(),
        Foreground::Dark => signed.map(|s| -s).collect(),
        Foreground::Light => signed.collect(),
    }
}

/// Whether what differs from the air below the cut is darker, brighter or both.
fn polarity(bed: &[f32], air_tone: f32, threshold: f64) -> Foreground {
    let beyond = bed
        .iter()
        .filter(|v| f64::from((*v - air_tone).abs()) > threshold);
    let n = beyond.clone().count().max(1) as f64;
    let part = beyond.filter(|v| **v < air_tone).count() as f64 / n;
    if part >= ONE_SIDED {
        Foreground::Dark
    } else if part <= 1.0 - ONE_SIDED {
        Foreground::Light
    } else {
        Foreground::Auto
    }
}

/// Threshold of the distances from the air tone inside the disc.
fn threshold(inside: &[bool], distance: &[f32]) -> Result<f64, Refusal> {
    let mut histogram = [0_u64; 256];
    for (value, _) in distance.iter().zip(inside).filter(|(_, inside)| **inside) {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to 0..=255"
        )]
        let level = value.round().clamp(0.0, 255.0) as usize;
        histogram[level] += 1;
    }
    otsu_threshold(&histogram).ok_or(Refusal::OneTone { difference: 0.0 })
}

/// The cells on either side of the straight cut that tells most about the level.
pub(crate) struct Sides {
    /// Cells above the cut.
    pub(crate) above: Vec<usize>,
    /// Cells below it.
    pub(crate) below: Vec<usize>,
    /// What the side tells about the level, nat.
    pub(crate) information: f64,
}

/// Parts the cells of a view by the straight cut that tells most about their levels; none if no cut tells anything.
pub(crate) fn straight_sides(view: &DiscView, levels: &[f32]) -> Option<Sides> {
    let (cut, information) = best_cut(view, levels)?;
    let inside = (0..levels.len()).filter(|k| view.inside[*k]);
    let (above, below) = inside.partition(|k| cut.is_above(view, *k));
    Some(Sides {
        above,
        below,
        information,
    })
}

/// A straight cut through the disc.
#[derive(Debug, Clone, Copy)]
struct Cut {
    /// Unit normal, pointing up: x part, 1.
    nx: f64,
    /// Unit normal, pointing up: y part, 1.
    ny: f64,
    /// Distance from the axis along the normal, px.
    offset: f64,
}

impl Cut {
    /// Whether a cell lies above the cut.
    fn is_above(&self, view: &DiscView, k: usize) -> bool {
        let (x, y) = view.position(k);
        x * self.nx + y * self.ny > self.offset
    }
}

/// The straight cut whose side tells most about the grey level.
///
/// # Formula
/// Largest mutual information `H(side) + H(class) - H(side, class)` of side and grey class; the
/// classes hold equally many cells. It finds texture against a plain tone as well as dark
/// against bright, whichever way round. Returns the cut and its information (nat), `None` when no cut tells anything.
fn best_cut(view: &DiscView, levels: &[f32]) -> Option<(Cut, f64)> {
    let cells: Vec<usize> = (0..view.inside.len()).filter(|k| view.inside[*k]).collect();
    let cells: Vec<usize> = cells
        .iter()
        .step_by((cells.len() / SEARCH_CELLS).max(1))
        .copied()
        .collect();
    let classes = gray_classes(levels, &cells);
    let places: Vec<(f64, f64)> = cells.iter().map(|k| view.position(*k)).collect();
    let radius = 0.5 * view.n as f64 * view.cell * REACH;
    let (mut best, mut cut) = (1e-6, None);
    for i_direction in 0..N_DIRECTIONS {
        let direction = (f64::from(i_direction) * 5.0 - 80.0).to_radians();
        let (nx, ny) = (-direction.sin(), direction.cos());
        let mut counts = [[0.0_f64; N_CLASSES]; N_OFFSETS];
        for ((x, y), class) in places.iter().zip(&classes) {
            let height = 0.5 * ((x * nx + y * ny) / radius + 1.0) * N_OFFSETS as f64;
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "clamped to the steps"
            )]
            let step = height.clamp(0.0, N_OFFSETS as f64 - 1.0) as usize;
            counts[step][*class] += 1.0;
        }
        for (step, information) in informations(&counts).into_iter().enumerate() {
            if information > best {
                best = information;
                let offset = ((step + 1) as f64 / N_OFFSETS as f64 * 2.0 - 1.0) * radius;
                cut = Some((Cut { nx, ny, offset }, information));
            }
        }
    }
    cut
}

/// Class of each cell by the rank of its grey level; equal levels share a class.
fn gray_classes(gray: &[f32], cells: &[usize]) -> Vec<usize> {
    let mut sorted: Vec<f32> = cells.iter().map(|k| gray[*k]).collect();
    sorted.sort_unstable_by(f32::total_cmp);
    let limits: Vec<f32> = (1..N_CLASSES)
        .map(|c| sorted[c * (sorted.len() - 1) / N_CLASSES])
        .collect();
    cells
        .iter()
        .map(|k| limits.partition_point(|l| *l < gray[*k]))
        .collect()
}

/// Mutual information of side and class for a cut above each step, nat.
fn informations(counts: &[[f64; N_CLASSES]; N_OFFSETS]) -> Vec<f64> {
    let mut total = [0.0; N_CLASSES];
    for row in counts {
        total.iter_mut().zip(row).for_each(|(t, c)| *t += c);
    }
    let all: f64 = total.iter().sum();
    let entropy = |n: f64| {
        if n > 0.0 {
            -n / all * (n / all).ln()
        } else {
            0.0
        }
    };
    let of_class: f64 = total.iter().map(|n| entropy(*n)).sum();
    let mut below = [0.0; N_CLASSES];
    counts[..N_OFFSETS - 1]
        .iter()
        .map(|row| {
            below.iter_mut().zip(row).for_each(|(b, c)| *b += c);
            let n_below: f64 = below.iter().sum();
            let joint: f64 = below
                .iter()
                .zip(&total)
                .map(|(b, t)| entropy(*b) + entropy(t - b))
                .sum();
            entropy(n_below) + entropy(all - n_below) + of_class - joint
        })
        .collect()
}
