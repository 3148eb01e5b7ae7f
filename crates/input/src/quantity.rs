//! Lengths, angles, speeds and other scalars read with their unit and checked; numbers printed with their significant digits.
//!
//! A file says `radius = "0.45 mm"`; the code holds 0.00045 m. A bare number, a unit of the wrong
//! kind and an invalid value are errors that name the remedy.
//!
//! ```
//! use input::quantity::{AngularSpeed, Length, Restitution};
//! assert_eq!(Length::parse("0.45 mm")?.si(), 0.00045);
//! assert_eq!(AngularSpeed::parse("60 rpm")?.si(), std::f64::consts::TAU);
//! assert!(Length::parse("10 rpm").is_err());
//! assert!(Restitution::new(1.2).is_err());
//! # Ok::<(), input::quantity::Error>(())
//! ```
//!
//! Invariants: every value is finite; inside, all values are SI and radians; text written by
//! `Display` or `Serialize` reads back to the same bits.

mod dimensional;
mod error;
mod numbers;
mod scalar;
mod significant;
mod unit;

pub use dimensional::{
    Angle, AngularSpeed, Density, Frequency, Length, Mass, Pressure, Speed, Time,
};
pub use error::Error;
pub use numbers::{numbers, places};
pub use scalar::{Fraction, FrictionCoefficient, PoissonRatio, PositiveCount, Restitution};
pub use significant::significant;
pub use unit::Kind;
