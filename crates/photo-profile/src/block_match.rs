//! A block of grey levels, and where it is found again.

/// Grey levels on a grid, less their mean.
#[derive(Debug, Clone)]
pub(crate) struct Block {
    /// Columns and rows.
    size: [usize; 2],
    /// Row by row, grey levels about their mean.
    values: Vec<f64>,
    /// Root of the sum of their squares.
    norm: f64,
}

/// The best place of a block in another picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Match {
    /// How far it lies along the columns, cells.
    pub(crate) shift: f64,
    /// Correlation there, -1 to 1.
    pub(crate) correlation: f64,
    /// Highest correlation at any place farther from it than `apart` cells; 0 where all are lower.
    pub(crate) rival: f64,
}

impl Block {
    /// The block of so many columns and rows of grey levels at (column, row).
    pub(crate) fn new([columns, rows]: [usize; 2], grey: impl Fn(f64, f64) -> f64) -> Self {
        let mut values = Vec::with_capacity(columns * rows);
        for j in 0..rows {
            values.extend((0..columns).map(|i| grey(i as f64, j as f64)));
        }
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        for value in &mut values {
            *value -= mean;
        }
        let norm = values.iter().map(|v| v * v).sum::<f64>().sqrt();
        Self {
            size: [columns, rows],
            values,
            norm,
        }
    }

    /// Standard deviation of the grey levels.
    pub(crate) fn standard_deviation(&self) -> f64 {
        self.norm / (self.values.len().max(1) as f64).sqrt()
    }
}

/// Searches a block within a reach along the columns and the rows (cells); none if its best place lies at the end of the
/// reach. `grey` gives the other picture in the cells of the block.
///
/// # Formula
///
/// Normalised cross-correlation `sum a b / sqrt(sum a^2 sum b^2)` of the grey levels less their means; between cells the top of
/// the parabola through the best place and its neighbours along the columns.
pub(crate) fn find_again(
    block: &Block,
    grey: impl Fn(f64, f64) -> f64,
    reach: [f64; 2],
    apart: f64,
) -> Option<Match> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a part of the drum radius in cells"
    )]
    let [along, across] = reach.map(|cells| cells.max(1.0) as usize);
    let [columns, rows] = block.size;
    let width = columns + 2 * along;
    let height = rows + 2 * across;
    let mut other = Vec::with_capacity(width * height);
    for j in 0..height {
        let row = j as f64 - across as f64;
        other.extend((0..width).map(|i| grey(i as f64 - along as f64, row)));
    }
    let correlation = |i: usize, j: usize| {
        let (mut product, mut sum, mut square) = (0.0, 0.0, 0.0);
        for (row, values) in block.values.chunks_exact(columns).enumerate() {
            let there = &other[(j + row) * width + i..][..columns];
            for (a, b) in values.iter().zip(there) {
                product += a * b;
                sum += b;
                square += b * b;
            }
        }
        let about_mean = (square - sum * sum / block.values.len() as f64).max(0.0);
        product / (block.norm * about_mean.sqrt()).max(f64::MIN_POSITIVE)
    };
    let mut all = Vec::with_capacity((2 * along + 1) * (2 * across + 1));
    for j in 0..=2 * across {
        all.extend((0..=2 * along).map(|i| (correlation(i, j), i, j)));
    }
    let (top, i, j) = *all.iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let at_end = i == 0 || i == 2 * along || j == 0 || j == 2 * across;
    if at_end || !top.is_finite() {
        return None;
    }
    let far = |p: &&(f64, usize, usize)| p.1.abs_diff(i).max(p.2.abs_diff(j)) as f64 > apart;
    let rival = all.iter().filter(far).map(|p| p.0).fold(0.0, f64::max);
    let (before, behind) = (correlation(i - 1, j), correlation(i + 1, j));
    let bend = before + behind - 2.0 * top;
    let off = if bend < 0.0 {
        0.5 * (before - behind) / bend
    } else {
        0.0
    };
    Some(Match {
        shift: i as f64 - along as f64 + off,
        correlation: top,
        rival,
    })
}

#[cfg(test)]
mod tests {
    use super::{Block, find_again};

    /// A texture of waves of 12 to 40 cells, moved by whole and broken numbers of cells: the parabola is off by less than 0.03
    /// of a cell, since it is not a parabola. Half a cell off the grid, a wave of 12.6 cells correlates by cos(0.25) = 0.97.
    #[test]
    fn a_moved_block_is_found_between_the_cells() {
        let wave = |x: f64, y: f64| {
            100.0
                + 30.0 * (x / 2.0).sin()
                + 20.0 * (x / 5.0 + y / 3.0).cos()
                + 15.0 * (y / 2.5 - x / 6.3).sin()
        };
        let block = Block::new([40, 16], wave);
        for moved in [0.0, 3.0, -4.25, 6.5, 0.4] {
            let found =
                find_again(&block, |x, y| wave(x - moved, y - 1.0), [10.0, 3.0], 4.0).unwrap();
            assert!((found.shift - moved).abs() < 0.03, "{found:?} for {moved}");
            assert!(found.correlation > 0.965, "{found:?} for {moved}");
        }
    }

    /// Stripes of 6 cells behind a row of light look the same six cells on: the rival is as high as the best.
    #[test]
    fn stripes_have_a_rival() {
        let stripes = |x: f64, y: f64| {
            (std::f64::consts::TAU * x / 6.0).sin() + (-0.5 * (y - 4.0).powi(2)).exp()
        };
        let block = Block::new([24, 8], stripes);
        let moved = |x: f64, y: f64| stripes(x - 1.0, y);
        let found = find_again(&block, moved, [9.0, 2.0], 4.0).unwrap();
        assert!(found.rival > 0.99, "{found:?}");
    }

    #[test]
    fn a_block_that_moved_too_far_is_not_found() {
        // One bright spot, which moves to the end of the reach and beyond.
        let spot = |x: f64, y: f64| (-((x - 10.0).powi(2) + (y - 5.0).powi(2)) / 8.0).exp();
        let block = Block::new([20, 10], spot);
        let moved = |by: f64| find_again(&block, |x, y| spot(x - by, y), [6.0, 2.0], 3.0);
        assert!(moved(5.0).is_some());
        assert_eq!(moved(6.0), None);
        let level = find_again(&block, |_, _| 7.0, [6.0, 2.0], 3.0);
        assert!(level.is_none_or(|m| m.correlation < 0.1), "{level:?}");
    }
}
