//! How far the surface of a bed moves from one picture to the next.

use crate::block_match::{Block, Match, find_again};
use crate::{DrumReading, PhotoPixels, PhotoReading, PixelPoint};
use surface_profile::median;

/// Part of the half-chord, about the middle of the surface, in which it is looked at: there it flows along itself, and neither
/// into the bed nor out of it.
const STRETCH: f64 = 0.5;
/// Length of a block along the surface, in drum radii. It holds some seeds of a tenth of the radius.
const LENGTH: f64 = 0.3;
/// Distance between the middles of blocks, in drum radii: they overlap by two thirds.
const STEP: f64 = 0.1;
/// Depth at which a block begins below the surface, and at which it ends, in drum radii. What is deeper flows more slowly.
const DEPTHS: [f64; 2] = [0.02, 0.12];
/// Farthest shift that is searched along the surface, either way, in drum radii.
const RANGE: f64 = 0.15;
/// Farthest shift that is searched across it, in drum radii: the surface is not straight.
const ACROSS: f64 = 0.03;
/// Cells along the drum radius at most.
const CELLS_PER_RADIUS: f64 = 200.0;
/// Least standard deviation of the grey levels of a block, of 255: below, noise of the picture is what is found again.
const LEAST_TEXTURE: f64 = 3.0;
/// Least correlation of a block with the place where it is found again.
const LEAST_CORRELATION: f64 = 0.6;
/// By what factor this correlation must be higher than at any place farther than [`APART`] from it: where seeds look alike, a
/// block is like many places.
const LEAST_OVER_RIVAL: f64 = 1.2;
/// Places so near count as one, in drum radii: about the size of a seed.
const APART: f64 = 0.05;
/// Blocks count whose shift lies so near to the median, in drum radii: a fifth of the range, over which shifts by chance spread.
const AGREE: f64 = 0.03;
/// Fewest blocks whose median counts.
const LEAST_BLOCKS: usize = 3;

/// How far the surface moved between two pictures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceShift {
    /// Median over the blocks, downhill positive, drum radii.
    pub shift: f64,
    /// Blocks that were found again.
    pub blocks: usize,
}

/// Why a shift was not measured.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoShift {
    /// The first picture shows no surface.
    #[error("the first picture shows no surface of a drum")]
    NoSurface,
    /// The pictures have not the same size.
    #[error("the pictures have {first} and {second} px: a pair must show the same section")]
    OtherSize {
        /// Pixels of the first.
        first: String,
        /// Pixels of the second.
        second: String,
    },
    /// The bed has one tone.
    #[error(
        "the bed shows no texture: {blocks} blocks below the surface vary by {least} of 255 grey levels or more, {needed} are \
         needed; take sharper pictures, or mark some seeds"
    )]
    Featureless {
        /// Blocks with texture.
        blocks: usize,
        /// Least standard deviation, grey levels.
        least: f64,
        /// Fewest blocks needed.
        needed: usize,
    },
    /// Blocks are not found again.
    #[error(
        "only {found} of {blocks} blocks below the surface are found again within {range} of the drum radius: it moves farther \
         between the two pictures, or its seeds turn over; take them closer together"
    )]
    Lost {
        /// Blocks that were found again.
        found: usize,
        /// Blocks with texture.
        blocks: usize,
        /// How far they are searched, drum radii.
        range: f64,
    },
}

/// How far the surface moves along itself from one picture to the next; `reading` is that of the first.
///
/// # Formula
///
/// Blocks of 0.3 by 0.1 drum radii, 0.02 radii below the surface of the middle half of the chord, are searched in the second
/// picture by the normalised cross-correlation of their grey levels, 0.15 radii along the surface line either way and 0.03
/// across it; the highest correlation and its neighbours along the line give a parabola, whose top is the shift. Blocks of one
/// tone are left out, and blocks that correlate by less than 0.6, by less than 1.2 times their correlation with another place
/// 0.05 radii away, or whose best place lies at the end of the search. The shift is the median of the others; it is missing
/// if fewer than three, or fewer than half of all blocks with texture, agree with it to 0.03 radii.
///
/// # Source
///
/// Correlation of blocks and parabola: `[WillertGharib1991]`; the rival: `[KeaneAdrian1992]`. Sizes and limits are ours.
///
/// # Errors
///
/// Every [`NoShift`].
pub fn surface_shift(
    first: &PhotoPixels,
    second: &PhotoPixels,
    reading: &PhotoReading,
) -> Result<SurfaceShift, NoShift> {
    let size = |p: &PhotoPixels| (p.width(), p.height());
    if size(first) != size(second) {
        let words = |p: &PhotoPixels| format!("{} x {}", p.width(), p.height());
        return Err(NoShift::OtherSize {
            first: words(first),
            second: words(second),
        });
    }
    let bed = reading.bed().ok_or(NoShift::NoSurface)?;
    let strip = Strip::of(bed).ok_or(NoShift::NoSurface)?;
    let [first, second] = [first, second].map(|picture| picture.channel(bed.channel));
    let (first, second) = (&*first, &*second);
    let blocks = strip.blocks(first);
    if blocks.len() < LEAST_BLOCKS {
        return Err(NoShift::Featureless {
            blocks: blocks.len(),
            least: LEAST_TEXTURE,
            needed: LEAST_BLOCKS,
        });
    }
    let reach = [RANGE, ACROSS].map(|part| part * strip.radius / strip.cell);
    let apart = APART * strip.radius / strip.cell;
    let found = blocks.iter().filter_map(|block| {
        let look = |i: f64, j: f64| strip.grey(second, block.along + i, block.depth + j);
        let Match {
            shift,
            correlation,
            rival,
        } = find_again(&block.texture, look, reach, apart)?;
        let told = correlation >= LEAST_CORRELATION && correlation >= LEAST_OVER_RIVAL * rival;
        told.then_some(shift * strip.cell / strip.radius)
    });
    let mut shifts: Vec<f64> = found.collect();
    let middle = median(&mut shifts);
    shifts.retain(|shift| (shift - middle).abs() <= AGREE);
    if shifts.len() < LEAST_BLOCKS || 2 * shifts.len() < blocks.len() {
        return Err(NoShift::Lost {
            found: shifts.len(),
            blocks: blocks.len(),
            range: RANGE,
        });
    }
    Ok(SurfaceShift {
        blocks: shifts.len(),
        shift: median(&mut shifts),
    })
}

/// The bed below the surface, in cells along the surface line and across it.
struct Strip {
    /// Middle of the drum, px.
    middle: PixelPoint,
    /// Radius of the drum, px.
    radius: f64,
    /// Edge of a cell, px.
    cell: f64,
    /// Unit vector downhill, px.
    downhill: [f64; 2],
    /// Unit vector into the bed, px.
    inwards: [f64; 2],
    /// Half of the chord, cells.
    half_chord: f64,
    /// Points of the surface: along and depth from the middle, cells.
    surface: Vec<(f64, f64)>,
}

/// A block and where it lies, in cells.
struct Placed {
    /// Its first column.
    along: f64,
    /// Its first row.
    depth: f64,
    /// Its grey levels.
    texture: Block,
}

impl Strip {
    /// The strip of a bed; none of a surface without a length.
    fn of(bed: &DrumReading) -> Option<Self> {
        let drum = bed.drum;
        let [high, low] = bed.line_ends;
        let (x, y) = (low.x - high.x, low.y - high.y);
        let chord = x.hypot(y);
        if chord.is_nan() || chord <= 0.0 {
            return None;
        }
        let downhill = [x / chord, y / chord];
        // The normal that points down in the picture: the line is less steep than a wall.
        let side = if downhill[0] < 0.0 { -1.0 } else { 1.0 };
        let cell = (drum.r / CELLS_PER_RADIUS).max(1.0);
        let mut strip = Self {
            middle: PixelPoint {
                x: drum.cx,
                y: drum.cy,
            },
            radius: drum.r,
            cell,
            downhill,
            inwards: [-side * downhill[1], side * downhill[0]],
            half_chord: 0.5 * chord / cell,
            surface: Vec::new(),
        };
        let project = |p: &PixelPoint| {
            let (x, y) = ((p.x - drum.cx) / cell, (p.y - drum.cy) / cell);
            let [along, depth] = [strip.downhill, strip.inwards].map(|d| x * d[0] + y * d[1]);
            (along, depth)
        };
        strip.surface = bed.used.iter().map(project).collect();
        Some(strip)
    }

    /// Grey level of a picture at a place in cells.
    fn grey(&self, picture: &PhotoPixels, along: f64, depth: f64) -> f64 {
        let [(ux, uy), (vx, vy)] =
            [self.downhill, self.inwards].map(|d| (d[0] * self.cell, d[1] * self.cell));
        let x = self.middle.x + along * ux + depth * vx;
        let y = self.middle.y + along * uy + depth * vy;
        picture.at(x, y)
    }

    /// Blocks with texture below the middle of the surface.
    fn blocks(&self, picture: &PhotoPixels) -> Vec<Placed> {
        let per_radius = self.radius / self.cell;
        let (length, step) = (LENGTH * per_radius, STEP * per_radius);
        let reach = (STRETCH * self.half_chord - 0.5 * length).max(0.0);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "at most the chord over a tenth of the radius, and cells of a block"
        )]
        let (each_way, columns, rows) = (
            (reach / step) as i32,
            length.round() as usize,
            ((DEPTHS[1] - DEPTHS[0]) * per_radius).round() as usize,
        );
        let place = |k: i32| {
            let along = f64::from(k) * step - 0.5 * length;
            let over = self
                .surface
                .iter()
                .filter(|p| (p.0 - along - 0.5 * length).abs() <= 0.5 * length);
            let mut depths: Vec<f64> = over.map(|p| p.1).collect();
            if depths.is_empty() {
                return None;
            }
            let depth = median(&mut depths) + DEPTHS[0] * per_radius;
            let grey = |i: f64, j: f64| self.grey(picture, along + i, depth + j);
            let texture = Block::new([columns, rows], grey);
            (texture.standard_deviation() >= LEAST_TEXTURE).then_some(Placed {
                along,
                depth,
                texture,
            })
        };
        (-each_way..=each_way).filter_map(place).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{NoShift, surface_shift};
    use crate::{PhotoPixels, Settings, measure_photo};
    use dev_support::drawn_pictures::Scene;
    use probability::random_stream::Stream;

    /// A bed whose texture is soft spots, moved downhill by so many pixels in the layer below the surface.
    fn bed(inclination: f64, moved: f64, tone: f64) -> PhotoPixels {
        let scene = Scene {
            size: 480,
            radius: 222.0,
            inclination,
            bed: 70.0,
            ..Scene::default()
        };
        let mut picture = scene.draw();
        let mut stream = Stream::new(4, "texture of a bed");
        let spots: Vec<[f64; 4]> = (0..500)
            .map(|_| {
                let (u, v) = (stream.between(-180.0, 180.0), stream.between(2.0, 60.0));
                [u, v, stream.between(3.0, 7.0), tone * stream.normal()]
            })
            .collect();
        let downhill = -inclination.signum();
        let (sin, cos) = inclination.sin_cos();
        for (column, row, pixel) in picture.enumerate_pixels_mut() {
            let (x, y) = (f64::from(column) - 239.5, 239.5 - f64::from(row));
            let (u, depth) = (downhill * (x * cos + y * sin), x * sin - y * cos);
            if !(2.0..=50.0).contains(&depth) || x.hypot(y) > 210.0 {
                continue;
            }
            let near = spots.iter().filter(|s| (s[1] - depth).abs() < 3.0 * s[2]);
            let sum: f64 = near
                .map(|[su, sv, size, tone]| {
                    let square = (u - moved - su).powi(2) + (depth - sv).powi(2);
                    tone * (-0.5 * square / (size * size)).exp()
                })
                .sum();
            pixel.0[0] = crate::pixels::to_level(70.0 + sum);
        }
        PhotoPixels::from_gray(&picture)
    }

    /// 5.3, 12.75 and -8.4 px of a drum of 222 px, on a surface that falls to the right and one that falls to the left: within
    /// 2 % of the larger shifts, and 0.1 px, the parabola's own error and that of the resampling.
    #[test]
    fn a_drawn_texture_has_the_shift_by_which_it_was_moved() {
        for inclination in [-0.6, 0.5] {
            let first = bed(inclination, 0.0, 20.0);
            let reading = measure_photo(&first, &Settings::default()).unwrap();
            for moved in [5.3, 12.75, -8.4] {
                let second = bed(inclination, moved, 20.0);
                let found = surface_shift(&first, &second, &reading).unwrap();
                let shift = found.shift * 222.0;
                assert!(
                    (shift - moved).abs() < 0.02 * moved.abs(),
                    "{shift} px for {moved}, {found:?}"
                );
            }
        }
    }

    /// A bed of one tone, one that moved by a fifth of the radius, and one that is another bed have no shift, and say why.
    #[test]
    fn what_is_not_found_again_has_no_shift() {
        let plain = bed(-0.6, 0.0, 0.0);
        let reading = measure_photo(&plain, &Settings::default()).unwrap();
        let told = surface_shift(&plain, &plain, &reading).unwrap_err();
        assert!(matches!(told, NoShift::Featureless { .. }), "{told}");
        let first = bed(-0.6, 0.0, 20.0);
        let reading = measure_photo(&first, &Settings::default()).unwrap();
        for moved in [45.0, 150.0] {
            let told = surface_shift(&first, &bed(-0.6, moved, 20.0), &reading).unwrap_err();
            assert!(matches!(told, NoShift::Lost { .. }), "{told}");
        }
        let small = PhotoPixels::from_gray(&image::GrayImage::new(100, 100));
        let told = surface_shift(&first, &small, &reading).unwrap_err();
        assert!(
            told.to_string().contains("480 x 480 and 100 x 100"),
            "{told}"
        );
        let none = measure_photo(&small, &Settings::default()).unwrap();
        let told = surface_shift(&first, &first, &none).unwrap_err();
        assert_eq!(told, NoShift::NoSurface);
    }
}
