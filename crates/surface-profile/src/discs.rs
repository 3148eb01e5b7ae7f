//! The free surface of a simulated bed: spheres projected along the drum axis.

use crate::{DrumCircle, Error, Field, SurfacePoint, bulk_level, free_surface};
use serde::{Deserialize, Serialize};

/// A sphere seen along the drum axis; x to the right, y up.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Disc {
    /// Horizontal coordinate of the centre, unit of the drum.
    pub x: f64,
    /// Vertical coordinate of the centre, positive up, unit of the drum.
    pub y: f64,
    /// Radius of the sphere, unit of the drum.
    pub radius: f64,
}

/// Settings of the projected density.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DensitySettings {
    /// Edge of a cell of the density grid, unit of the drum.
    pub cell: f64,
    /// Standard deviation of the Gaussian that smooths the density, unit of the drum.
    pub smoothing: f64,
}

impl DensitySettings {
    /// The settings for a drum: cells of radius/70 (1 mm in the drum of 140 mm) and smoothing
    /// over 0.03 of the radius.
    ///
    /// The smoothing is the one that photos get. Doubling it moves the angle of a straight
    /// surface by nothing; [`free_surface`] corrects its effect on a curved one.
    pub fn for_drum(drum: &DrumCircle) -> Self {
        Self {
            cell: drum.radius / 70.0,
            smoothing: 0.03 * drum.radius,
        }
    }
}

/// Part of the drum radius up to which the density is read; beyond, the wall orders the bed.
const REACH: f64 = 0.97;
/// Largest number of cells across the drum; more indicates a wrong unit.
const MOST_CELLS: f64 = 4000.0;

/// Free surface of a simulated bed, to be given to [`crate::measure`].
///
/// # Formula
/// Contour of half of the bulk density in the smoothed projected density
/// ([`density_of_discs`], [`bulk_level`]), read along the normal of the surface line
/// ([`free_surface`]). A sphere outside the drum adds nothing.
///
/// # Errors
/// [`Error::BadDrum`], [`Error::BadSetting`], [`Error::NotFinite`], [`Error::NoSurface`] for an
/// empty or full drum, and the errors of [`crate::read_surface`].
pub fn profile_from_discs(
    discs: &[Disc],
    drum: &DrumCircle,
    settings: &DensitySettings,
) -> Result<Vec<SurfacePoint>, Error> {
    let density = density_of_discs(discs, drum, settings)?;
    let level = bulk_level(&density, drum);
    if level <= 0.0 {
        return Err(Error::NoSurface {
            fraction: 0.0,
            least: 0.02,
            most: 0.98,
        });
    }
    free_surface(&density, level, drum, REACH)
}

/// Smoothed projected density: length of solid along the axis over each cell.
///
/// # Formula
/// A sphere adds `2 sqrt(r^2 - d^2)` at the distance d from its centre, scaled so that the sum
/// over cells is its volume `4/3 pi r^3`. Smoothing is a Gaussian whose part inside the drum
/// counts: `G * density / G * indicator of the drum`, so that the wall does not thin the bed.
/// Overlaps of the spheres of one seed count twice; half of the bulk follows, because the bulk
/// counts them too.
///
/// # Errors
/// [`Error::BadDrum`], [`Error::BadSetting`], [`Error::NotFinite`].
pub fn density_of_discs(
    discs: &[Disc],
    drum: &DrumCircle,
    settings: &DensitySettings,
) -> Result<Field, Error> {
    check(discs, drum, settings)?;
    let grid = DensityGrid::around(drum, settings);
    let mut density = vec![0.0_f64; grid.n * grid.n];
    for disc in discs {
        grid.deposit(disc, &mut density);
    }
    let mut inside = vec![0.0_f64; grid.n * grid.n];
    for (k, value) in inside.iter_mut().enumerate() {
        let (x, y) = (
            grid.x + (k % grid.n) as f64 * grid.cell,
            grid.y + (k / grid.n) as f64 * grid.cell,
        );
        if (x - drum.x).hypot(y - drum.y) <= drum.radius {
            *value = 1.0;
        } else {
            density[k] = 0.0;
        }
    }
    let sd = settings.smoothing / settings.cell;
    let (density, weight) = (grid.smooth(&density, sd), grid.smooth(&inside, sd));
    #[expect(clippy::cast_possible_truncation, reason = "a field holds f32")]
    let values = density
        .iter()
        .zip(&weight)
        .map(|(d, w)| if *w > 1e-6 { (d / w) as f32 } else { 0.0 })
        .collect();
    Field::new(
        SurfacePoint {
            x: grid.x,
            y: grid.y,
        },
        grid.cell,
        grid.n,
        values,
    )?
    .smoothed_by(settings.smoothing)
}

/// Refuses discs, drum and invalid settings.
fn check(discs: &[Disc], drum: &DrumCircle, settings: &DensitySettings) -> Result<(), Error> {
    drum.check()?;
    let cells = 2.0 * drum.radius / settings.cell;
    if !(settings.cell > 0.0 && (10.0..=MOST_CELLS).contains(&cells)) {
        return Err(Error::BadSetting {
            name: "cell",
            value: settings.cell,
            limit: "a five-hundredth part to a fifth of the drum radius, in the unit of the drum",
        });
    }
    if !(settings.smoothing >= 0.0 && settings.smoothing <= drum.radius) {
        return Err(Error::BadSetting {
            name: "smoothing",
            value: settings.smoothing,
            limit: "0 to the drum radius, in the unit of the drum",
        });
    }
    for (index, disc) in discs.iter().enumerate() {
        for value in [disc.x, disc.y, disc.radius] {
            if !value.is_finite() {
                return Err(Error::NotFinite {
                    what: "coordinate of disc",
                    index,
                    value,
                });
            }
        }
        if disc.radius <= 0.0 || disc.radius > drum.radius {
            return Err(Error::BadSetting {
                name: "radius of a disc",
                value: disc.radius,
                limit: "positive and at most the drum radius",
            });
        }
    }
    Ok(())
}

/// The square grid around the drum.
struct DensityGrid {
    /// x of the first cell's centre, unit of the drum.
    x: f64,
    /// y of the first cell's centre, unit of the drum.
    y: f64,
    /// Edge of a cell, unit of the drum.
    cell: f64,
    /// Cells along either side.
    n: usize,
}

impl DensityGrid {
    /// The grid whose cells lie symmetrically about the axis and cover the drum.
    fn around(drum: &DrumCircle, settings: &DensitySettings) -> Self {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the number of cells across the drum was checked"
        )]
        let half = (drum.radius / settings.cell).ceil() as usize + 2;
        let reach = half as f64 * settings.cell;
        Self {
            x: drum.x - reach,
            y: drum.y - reach,
            cell: settings.cell,
            n: 2 * half + 1,
        }
    }

    /// Adds the volume of a sphere to the cells under it, per area of a cell.
    fn deposit(&self, disc: &Disc, density: &mut [f64]) {
        let volume = 4.0 / 3.0 * std::f64::consts::PI * disc.radius.powi(3);
        let (columns, rows) = (
            self.span(disc.x - self.x, disc.radius),
            self.span(disc.y - self.y, disc.radius),
        );
        let height = |i: usize, j: usize| {
            let dx = self.x + i as f64 * self.cell - disc.x;
            let dy = self.y + j as f64 * self.cell - disc.y;
            // A cell whose centre is within half a cell outside still holds some of the sphere.
            let reach = disc.radius + 0.5 * self.cell;
            (reach * reach - dx * dx - dy * dy).max(0.0).sqrt()
        };
        let sum: f64 = rows
            .clone()
            .map(|j| columns.clone().map(|i| height(i, j)).sum::<f64>())
            .sum();
        if sum <= 0.0 {
            return;
        }
        let scale = volume / (sum * self.cell * self.cell);
        for j in rows {
            for i in columns.clone() {
                density[j * self.n + i] += scale * height(i, j);
            }
        }
    }

    /// Cells within a cell and a radius of a coordinate that counts from the first centre.
    fn span(&self, coordinate: f64, radius: f64) -> std::ops::Range<usize> {
        let most = self.n as f64;
        let low = ((coordinate - radius) / self.cell - 1.0)
            .floor()
            .clamp(0.0, most);
        let high = ((coordinate + radius) / self.cell + 2.0)
            .ceil()
            .clamp(0.0, most);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to the grid"
        )]
        let range = low as usize..high as usize;
        range
    }

    /// Smooths along x, then along y with a Gaussian of `sd` cells, cut at four of them.
    fn smooth(&self, values: &[f64], sd: f64) -> Vec<f64> {
        if sd <= 0.0 {
            return values.to_vec();
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "smoothing is at most the drum radius, so this is at most four times the grid"
        )]
        let reach = (4.0 * sd).ceil() as usize;
        let kernel: Vec<f64> = (0..=reach)
            .map(|k| (-0.5 * (k as f64 / sd).powi(2)).exp())
            .collect();
        let total = 2.0 * kernel.iter().sum::<f64>() - 1.0;
        let pass = |from: &[f64], stride: usize, across: usize| {
            let mut to = vec![0.0; from.len()];
            for line in 0..self.n {
                for i in 0..self.n {
                    let low = i.saturating_sub(reach);
                    let high = (i + reach).min(self.n - 1);
                    let sum: f64 = (low..=high)
                        .map(|k| kernel[k.abs_diff(i)] * from[line * across + k * stride])
                        .sum();
                    to[line * across + i * stride] = sum / total;
                }
            }
            to
        };
        pass(&pass(values, 1, self.n), self.n, 1)
    }
}
