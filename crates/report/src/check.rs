//! Checks at the door of every chart.

use crate::Error;

/// Names one field of one chart in messages.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Field {
    /// Kind of chart.
    pub(crate) chart: &'static str,
    /// Name of the field.
    pub(crate) field: &'static str,
}

impl Field {
    pub(crate) const fn new(chart: &'static str, field: &'static str) -> Self {
        Self { chart, field }
    }

    /// Accepts finite numbers only.
    pub(crate) fn finite(self, values: impl IntoIterator<Item = f64>) -> Result<(), Error> {
        for (index, value) in values.into_iter().enumerate() {
            if !value.is_finite() {
                let Self { chart, field } = self;
                return Err(Error::NonFinite {
                    chart,
                    field,
                    index,
                    value,
                });
            }
        }
        Ok(())
    }

    /// Accepts finite numbers of at least 0 only.
    pub(crate) fn not_negative(self, values: impl IntoIterator<Item = f64>) -> Result<(), Error> {
        for (index, value) in values.into_iter().enumerate() {
            self.finite([value])?;
            if value < 0.0 {
                let requirement = "at least 0";
                let Self { chart, field } = self;
                return Err(Error::OutOfRange {
                    chart,
                    field,
                    index,
                    value,
                    requirement,
                });
            }
        }
        Ok(())
    }

    /// Accepts finite numbers, each above the one before it.
    pub(crate) fn ascending(self, values: &[f64]) -> Result<(), Error> {
        self.finite(values.iter().copied())?;
        let Self { chart, field } = self;
        for (index, pair) in (1..).zip(values.windows(2)) {
            if let &[before, value] = pair
                && value <= before
            {
                let requirement = "above the entry before it";
                return Err(Error::OutOfRange {
                    chart,
                    field,
                    index,
                    value,
                    requirement,
                });
            }
        }
        Ok(())
    }

    /// Accepts lists with at least `least` entries.
    pub(crate) fn at_least(self, least: usize, count: usize) -> Result<(), Error> {
        let Self { chart, field } = self;
        if count < least {
            return Err(Error::TooFew {
                chart,
                field,
                count,
                least,
            });
        }
        Ok(())
    }

    /// Accepts lists with one entry for `each` of something.
    pub(crate) fn length(
        self,
        expected: usize,
        each: &'static str,
        count: usize,
    ) -> Result<(), Error> {
        let Self { chart, field } = self;
        if count == expected {
            Ok(())
        } else {
            Err(Error::Length {
                chart,
                field,
                count,
                expected,
                each,
            })
        }
    }
}
