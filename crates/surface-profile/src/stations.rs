//! Stations: the surface averaged over equal steps along its line, with outliers set aside.

use crate::cubic::Cubic;
use crate::frame::SurfaceFrame;
use crate::median::median;
use crate::{DrumCircle, Error, SurfacePoint};

/// Part of the half-chord that carries stations. What lies beyond belongs to the rim (shadow,
/// curl, wall layer) and its visibility differs between pictures; on an S-shaped surface the
/// line would follow it, 0.1 degrees for a hundredth.
const REACH: f64 = 0.94;
/// Most stations along the chord. A hundredth of the chord is finer than any grain that the
/// drum can hold as a bulk; twice as many change a smooth surface's line by less than 1e-4 rad.
const MOST_STATIONS: usize = 100;
/// Fewest stations that still fix a cubic with residuals left.
const FEWEST_STATIONS: usize = 8;
/// Points beyond this many robust standard deviations from the cubic are outliers.
const CUT_IN_SD: f64 = 4.0;
/// No point nearer to the cubic than this part of the drum radius is an outlier: smooth
/// avalanche surfaces depart from a cubic by 1 or 2 hundredths of the radius. Twice as much
/// would let a curl at the rim pass.
const LEAST_CUT: f64 = 0.04;
/// Steps of reweighting; the weights settle to 1e-3 within 10.
const REWEIGHTINGS: usize = 15;

/// One station of the surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Station {
    /// Mean position along the line, downhill positive, in half-chords.
    pub(crate) along: f64,
    /// Mean height over the axis along the normal, unit of the caller.
    pub(crate) height: f64,
}

/// The surface as stations in its frame.
#[derive(Debug, Clone)]
pub(crate) struct Stations {
    /// Stations in order of `along`; empty ones left out.
    pub(crate) all: Vec<Station>,
    /// Half the chord that the surface line cuts out of the drum, unit of the caller.
    pub(crate) half_chord: f64,
    /// For each point of the input whether it counts.
    pub(crate) used: Vec<bool>,
}

impl Stations {
    /// Projects the points onto the frame, sets outliers aside and averages the rest.
    pub(crate) fn build(
        points: &[SurfacePoint],
        drum: &DrumCircle,
        frame: &SurfaceFrame,
    ) -> Result<Self, Error> {
        let mut projected: Vec<(f64, f64)> = points.iter().map(|p| frame.project(p)).collect();
        let distance = median(&mut projected.iter().map(|p| p.1).collect::<Vec<f64>>());
        let half_chord_squared = drum.radius * drum.radius - distance * distance;
        if half_chord_squared <= 0.0 {
            return Err(Error::OutsideDrum {
                distance: distance.abs(),
                radius: drum.radius,
            });
        }
        let half_chord = half_chord_squared.sqrt();
        for p in &mut projected {
            p.0 /= half_chord;
        }
        let all_used = vec![true; points.len()];
        let first = average(&projected, &all_used);
        let used = inliers(&projected, &first, drum.radius)?;
        let all = average(&projected, &used);
        if all.len() < FEWEST_STATIONS {
            return Err(Error::TooFewPoints {
                n: all.len(),
                least: FEWEST_STATIONS,
            });
        }
        Ok(Self {
            all,
            half_chord,
            used,
        })
    }

    /// Stations as (u, v), unit of the caller.
    pub(crate) fn positions(&self) -> impl Iterator<Item = (f64, f64)> + Clone + '_ {
        self.all
            .iter()
            .map(|s| (s.along * self.half_chord, s.height))
    }
}

/// Averages the used points (along in half-chords, height) in equal bins along the chord.
///
/// The bins end where the stations end: a last bin that holds a single point would weigh as much as a
/// full one, and turn an S-shaped surface by 0.1 degrees when that point comes or goes.
fn average(projected: &[(f64, f64)], used: &[bool]) -> Vec<Station> {
    let n_bins = (projected.len() / 2).clamp(FEWEST_STATIONS, MOST_STATIONS);
    let mut sums = vec![(0.0, 0.0, 0.0); n_bins];
    for (&(along, height), _) in projected
        .iter()
        .zip(used)
        .filter(|(p, used)| **used && p.0.abs() <= REACH)
    {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to 0..n_bins before the cast"
        )]
        let bin =
            (0.5 * (along / REACH + 1.0) * n_bins as f64).clamp(0.0, n_bins as f64 - 1.0) as usize;
        let sum = &mut sums[bin];
        *sum = (sum.0 + 1.0, sum.1 + along, sum.2 + height);
    }
    sums.iter()
        .filter(|s| s.0 > 0.0)
        .map(|s| Station {
            along: s.1 / s.0,
            height: s.2 / s.0,
        })
        .collect()
}

/// Flags the points that lie near the robust cubic through the stations.
///
/// The cubic, and not the line, is the yardstick, because the S of a fast drum is signal. It is
/// found by reweighting: first with weights `1 / |r|` (least absolute values), then with the
/// biweight `(1 - (r / 4.685 s)^2)^2` of `[BeatonTukey1974]`, `s = 1.4826 median |r|`.
fn inliers(
    projected: &[(f64, f64)],
    stations: &[Station],
    radius: f64,
) -> Result<Vec<bool>, Error> {
    let floor = LEAST_CUT * radius / CUT_IN_SD;
    let mut weights = vec![1.0; stations.len()];
    let mut scale = floor;
    let mut cubic = None;
    for step in 0..2 * REWEIGHTINGS {
        let points = stations
            .iter()
            .zip(&weights)
            .map(|(s, w)| (s.along, s.height, *w));
        let Some(fitted) = Cubic::fit(points) else {
            break;
        };
        cubic = Some(fitted);
        let residuals: Vec<f64> = stations
            .iter()
            .map(|s| (s.height - fitted.at(s.along)).abs())
            .collect();
        scale = (1.4826 * median(&mut residuals.clone())).max(floor);
        for (weight, residual) in weights.iter_mut().zip(&residuals) {
            *weight = if step < REWEIGHTINGS {
                scale / residual.max(0.1 * scale)
            } else {
                let t = residual / (4.685 * scale);
                (1.0 - t * t).max(0.0).powi(2)
            };
        }
    }
    let cubic = cubic.ok_or(Error::TooFewPoints {
        n: stations.len(),
        least: FEWEST_STATIONS,
    })?;
    Ok(projected
        .iter()
        .map(|p| (p.1 - cubic.at(p.0)).abs() <= CUT_IN_SD * scale)
        .collect())
}
