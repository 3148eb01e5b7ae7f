//! A scalar field on a grid of square cells.

use crate::Error;

/// A scalar field on square cells, x to the right, y up; zero outside.
#[derive(Debug, Clone)]
pub struct Field {
    /// x of the centre of the first cell, any unit of length.
    x: f64,
    /// y of the centre of the first cell, unit of `x`.
    y: f64,
    /// Edge of a cell, unit of `x`.
    cell: f64,
    /// Cells along x.
    columns: usize,
    /// Cells along y.
    rows: usize,
    /// Values, row by row from the lowest row, shape (rows, columns), any unit.
    values: Vec<f32>,
    /// Standard deviation of the Gaussian that the values were smoothed with, unit of `x`.
    smoothing: f64,
}

impl Field {
    /// A field whose first cell has its centre at `first`; values row by row from the lowest.
    ///
    /// # Errors
    /// [`Error::BadSetting`] for a cell that is not positive, [`Error::FieldShape`] for a wrong
    /// number of values, [`Error::NotFinite`] for NaN or infinity.
    pub fn new(
        first: crate::SurfacePoint,
        cell: f64,
        columns: usize,
        values: Vec<f32>,
    ) -> Result<Self, Error> {
        if !(cell.is_finite() && cell > 0.0) {
            return Err(Error::BadSetting {
                name: "cell",
                value: cell,
                limit: "a positive length in the unit of the drum",
            });
        }
        let rows = values.len().checked_div(columns).unwrap_or(0);
        if columns < 2 || rows < 2 || rows * columns != values.len() {
            return Err(Error::FieldShape {
                columns,
                rows,
                values: values.len(),
            });
        }
        let finite = first.x.is_finite() && first.y.is_finite();
        let bad = values.iter().position(|v| !v.is_finite());
        if let Some(index) = bad.or((!finite).then_some(0)) {
            let value = f64::from(values[index]);
            return Err(Error::NotFinite {
                what: "value of the field",
                index,
                value,
            });
        }
        Ok(Self {
            x: first.x,
            y: first.y,
            cell,
            columns,
            rows,
            values,
            smoothing: 0.0,
        })
    }

    /// States the Gaussian that smoothed the values, so that the free surface can be corrected
    /// for it; `sd` in the unit of the drum.
    ///
    /// # Errors
    /// [`Error::BadSetting`] unless `sd` is finite and not negative.
    pub fn smoothed_by(self, sd: f64) -> Result<Self, Error> {
        if sd.is_finite() && sd >= 0.0 {
            Ok(Self {
                smoothing: sd,
                ..self
            })
        } else {
            Err(Error::BadSetting {
                name: "smoothing",
                value: sd,
                limit: "0 or more, in the unit of the drum",
            })
        }
    }

    /// Standard deviation of the Gaussian that the values were smoothed with, unit of the drum.
    pub fn smoothing(&self) -> f64 {
        self.smoothing
    }

    /// Edge of a cell, unit of the drum.
    pub fn cell(&self) -> f64 {
        self.cell
    }

    /// Value at a place by bilinear interpolation between cell centres; zero outside.
    #[inline]
    pub fn at(&self, x: f64, y: f64) -> f64 {
        let column = (x - self.x) / self.cell;
        let row = (y - self.y) / self.cell;
        let inside = column >= 0.0
            && row >= 0.0
            && column < (self.columns - 1) as f64
            && row < (self.rows - 1) as f64;
        if !inside {
            return 0.0;
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "inside the grid"
        )]
        let (i, j) = (column as usize, row as usize);
        let (a, b) = (column - i as f64, row - j as f64);
        let along = |j: usize| {
            let pair = &self.values[j * self.columns + i..][..2];
            f64::from(pair[0]) * (1.0 - a) + f64::from(pair[1]) * a
        };
        along(j) * (1.0 - b) + along(j + 1) * b
    }

    /// Share of a disc, 0 to 1, whose cells lie above a level: the cells with their centre within `reach` (0 to 1) of the
    /// radius; 0 if there are none.
    pub fn share_above(&self, level: f64, drum: &crate::DrumCircle, reach: f64) -> f64 {
        let within = (reach * drum.radius).powi(2);
        let inside = |x: f64, y: f64| (x - drum.x).powi(2) + (y - drum.y).powi(2) <= within;
        let (mut above, mut all) = (0_usize, 0_usize);
        for (_, _, value) in self.cells().filter(|c| inside(c.0, c.1)) {
            all += 1;
            above += usize::from(value > level);
        }
        above as f64 / all.max(1) as f64
    }

    /// Cells with their centre: (x, y, value).
    pub fn cells(&self) -> impl Iterator<Item = (f64, f64, f64)> + '_ {
        self.values.iter().enumerate().map(|(k, &value)| {
            let x = self.x + (k % self.columns) as f64 * self.cell;
            let y = self.y + (k / self.columns) as f64 * self.cell;
            (x, y, f64::from(value))
        })
    }
}
