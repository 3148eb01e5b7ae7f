//! Dimensionless numbers with a possible range.

use std::fmt;
use std::num::NonZeroUsize;

use serde::{Deserialize, Serialize};

use crate::quantity::error::Error;

/// Defines one scalar: a finite number in a range.
macro_rules! scalar {
    (
        $(#[$doc:meta])*
        $name:ident, $what:literal, $limit:literal, $in_range:expr, $way_out:literal
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Serialize, Deserialize)]
        #[serde(try_from = "f64", into = "f64")]
        pub struct $name(f64);

        impl $name {
            /// Checks the value.
            ///
            /// # Errors
            /// A value that is not finite or out of range.
            pub fn new(value: f64) -> Result<Self, Error> {
                let in_range: fn(f64) -> bool = $in_range;
                if !value.is_finite() {
                    return Err(Error::NotFinite { what: $what, value });
                }
                if !in_range(value) {
                    return Err(Error::OutOfRange {
                        what: $what,
                        value: value.to_string(),
                        limit: $limit,
                        way_out: $way_out,
                    });
                }
                Ok(Self(value))
            }

            /// Returns the value.
            pub const fn get(self) -> f64 {
                self.0
            }
        }

        impl TryFrom<f64> for $name {
            type Error = Error;

            fn try_from(value: f64) -> Result<Self, Error> {
                Self::new(value)
            }
        }

        impl From<$name> for f64 {
            fn from(scalar: $name) -> Self {
                scalar.0
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0.fmt(formatter)
            }
        }
    };
}

scalar!(
    /// The coefficient of restitution: speed of separation over speed of approach.
    Restitution,
    "a coefficient of restitution",
    "from 0 to 1",
    |value| (0.0..=1.0).contains(&value),
    "give the ratio of the speeds after and before the impact (of a drop: the square root of \
     the ratio of the heights), not a percentage"
);
scalar!(
    /// A coefficient of sliding or rolling friction; it may exceed 1.
    FrictionCoefficient,
    "a coefficient of friction",
    "0 or more",
    |value| value >= 0.0,
    "give the tangent of the friction angle, without a direction"
);
scalar!(
    /// Poisson's ratio of an isotropic elastic body: more than -1, where a body would not yield
    /// to shear, up to 1/2, where it keeps its volume.
    PoissonRatio,
    "Poisson's ratio",
    "more than -1 and at most 0.5",
    |value| value > -1.0 && value <= 0.5,
    "seeds and resins lie between 0 and 0.5"
);
scalar!(
    /// A fraction of a whole.
    Fraction,
    "a fraction",
    "from 0 to 1",
    |value| (0.0..=1.0).contains(&value),
    "divide a percentage by 100"
);

/// A count of at least one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "i64")]
pub struct PositiveCount(NonZeroUsize);

impl PositiveCount {
    /// Checks the count.
    ///
    /// # Errors
    /// A count of zero.
    pub fn new(count: usize) -> Result<Self, Error> {
        NonZeroUsize::new(count)
            .map(Self)
            .ok_or_else(|| refused_count(0))
    }

    /// Returns the count.
    pub const fn get(self) -> usize {
        self.0.get()
    }
}

/// Makes the error for a count of zero.
fn refused_count(count: i64) -> Error {
    Error::OutOfRange {
        what: "a count",
        value: count.to_string(),
        limit: "1 or more",
        way_out: "leave the entry out if there is nothing to count",
    }
}

impl TryFrom<i64> for PositiveCount {
    type Error = Error;

    fn try_from(count: i64) -> Result<Self, Error> {
        usize::try_from(count)
            .map_err(|_| refused_count(count))
            .and_then(Self::new)
    }
}

impl fmt::Display for PositiveCount {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(formatter)
    }
}
