//! The kinds of quantities and the units that each of them accepts.

use std::f64::consts::PI;
use std::fmt;

/// The kind of a quantity, which decides the units that it accepts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A length or a coordinate, m.
    Length,
    /// A plane angle, rad.
    Angle,
    /// An angular speed, rad/s.
    AngularSpeed,
    /// A duration, s.
    Time,
    /// A mass, kg.
    Mass,
    /// A mass per volume, kg/m3.
    Density,
    /// A pressure, a stress or an elastic modulus, Pa.
    Pressure,
    /// A linear speed, m/s.
    Speed,
    /// A rate of events, Hz.
    Frequency,
}

/// A unit and its size.
#[derive(Debug)]
pub(crate) struct Unit {
    /// How the unit is written.
    pub(crate) text: &'static str,
    /// Kind of quantity.
    pub(crate) kind: Kind,
    /// SI units in one unit are `numerator / denominator`; kept apart so that 0.45 mm becomes
    /// 0.45 / 1000, which rounds once, instead of 0.45 * 0.001, which rounds twice.
    numerator: f64,
    /// See `numerator`.
    denominator: f64,
}

impl Unit {
    /// Converts a number of this unit to SI.
    pub(crate) fn to_si(&self, number: f64) -> f64 {
        number * self.numerator / self.denominator
    }
}

/// Makes one row of the table.
const fn unit(kind: Kind, text: &'static str, numerator: f64, denominator: f64) -> Unit {
    Unit {
        text,
        kind,
        numerator,
        denominator,
    }
}

/// All accepted units; the SI unit of a kind is the first of its rows.
static UNITS: [Unit; 36] = [
    unit(Kind::Length, "m", 1.0, 1.0),
    unit(Kind::Length, "cm", 1.0, 100.0),
    unit(Kind::Length, "mm", 1.0, 1e3),
    unit(Kind::Length, "um", 1.0, 1e6),
    unit(Kind::Length, "µm", 1.0, 1e6), // U+00B5, the micro sign of keyboards
    unit(Kind::Length, "μm", 1.0, 1e6), // U+03BC, the Greek letter
    unit(Kind::Angle, "rad", 1.0, 1.0),
    unit(Kind::Angle, "deg", PI / 180.0, 1.0),
    unit(Kind::Angle, "°", PI / 180.0, 1.0),
    unit(Kind::AngularSpeed, "rad/s", 1.0, 1.0),
    unit(Kind::AngularSpeed, "deg/s", PI / 180.0, 1.0),
    unit(Kind::AngularSpeed, "rpm", PI / 30.0, 1.0),
    unit(Kind::Time, "s", 1.0, 1.0),
    unit(Kind::Time, "ms", 1.0, 1e3),
    unit(Kind::Time, "us", 1.0, 1e6),
    unit(Kind::Time, "min", 60.0, 1.0),
    unit(Kind::Mass, "kg", 1.0, 1.0),
    unit(Kind::Mass, "g", 1.0, 1e3),
    unit(Kind::Mass, "mg", 1.0, 1e6),
    unit(Kind::Density, "kg/m3", 1.0, 1.0),
    unit(Kind::Density, "kg/m^3", 1.0, 1.0),
    unit(Kind::Density, "kg/m³", 1.0, 1.0),
    unit(Kind::Density, "g/cm3", 1e3, 1.0),
    unit(Kind::Density, "g/cm^3", 1e3, 1.0),
    unit(Kind::Density, "g/cm³", 1e3, 1.0),
    unit(Kind::Pressure, "Pa", 1.0, 1.0),
    unit(Kind::Pressure, "kPa", 1e3, 1.0),
    unit(Kind::Pressure, "MPa", 1e6, 1.0),
    unit(Kind::Pressure, "GPa", 1e9, 1.0),
    unit(Kind::Speed, "m/s", 1.0, 1.0),
    unit(Kind::Speed, "cm/s", 1.0, 100.0),
    unit(Kind::Speed, "mm/s", 1.0, 1e3),
    unit(Kind::Frequency, "Hz", 1.0, 1.0),
    unit(Kind::Frequency, "1/s", 1.0, 1.0),
    unit(Kind::Frequency, "kHz", 1e3, 1.0),
    unit(Kind::Frequency, "MHz", 1e6, 1.0),
];

impl Kind {
    /// Returns the units that this kind accepts, separated by commas.
    pub fn accepted(self) -> String {
        let texts: Vec<&str> = UNITS
            .iter()
            .filter(|unit| unit.kind == self)
            .map(|unit| unit.text)
            .collect();
        texts.join(", ")
    }

    /// Returns the SI unit of this kind.
    pub const fn si_unit(self) -> &'static str {
        match self {
            Self::Length => "m",
            Self::Angle => "rad",
            Self::AngularSpeed => "rad/s",
            Self::Time => "s",
            Self::Mass => "kg",
            Self::Density => "kg/m3",
            Self::Pressure => "Pa",
            Self::Speed => "m/s",
            Self::Frequency => "Hz",
        }
    }

    /// Returns a number with a unit as one would write it in a file.
    pub(crate) const fn example(self) -> &'static str {
        match self {
            Self::Length => "0.5 mm",
            Self::Angle => "30 deg",
            Self::AngularSpeed => "10 rpm",
            Self::Time => "2 s",
            Self::Mass => "50 mg",
            Self::Density => "1000 kg/m3",
            Self::Pressure => "5 MPa",
            Self::Speed => "0.1 m/s",
            Self::Frequency => "50 Hz",
        }
    }

    /// Returns the unit of `example`.
    pub(crate) fn example_unit(self) -> &'static str {
        self.example()
            .split_once(' ')
            .map_or(self.si_unit(), |(_, unit)| unit)
    }
}

impl fmt::Display for Kind {
    /// Writes the kind with its article, such as "an angular speed".
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Length => "a length",
            Self::Angle => "an angle",
            Self::AngularSpeed => "an angular speed",
            Self::Time => "a time",
            Self::Mass => "a mass",
            Self::Density => "a density",
            Self::Pressure => "a pressure",
            Self::Speed => "a speed",
            Self::Frequency => "a frequency",
        })
    }
}

/// Finds a unit by its text; capitals count, because mPa is not `MPa`.
pub(crate) fn find(text: &str) -> Option<&'static Unit> {
    UNITS.iter().find(|unit| unit.text == text)
}

#[cfg(test)]
mod tests {
    use super::{UNITS, find};

    #[test]
    fn every_unit_is_found_by_its_text_and_only_once() {
        for unit in &UNITS {
            let found = find(unit.text).expect("listed");
            assert!(std::ptr::eq(found, unit), "{} is listed twice", unit.text);
        }
    }

    #[test]
    fn si_unit_and_example_unit_of_each_kind_are_accepted_by_it() {
        for unit in &UNITS {
            let si = find(unit.kind.si_unit()).expect("the SI unit is listed");
            assert_eq!(si.kind, unit.kind, "{}", unit.kind);
            assert_eq!(si.to_si(1.0), 1.0, "{} has a size other than 1", si.text);
            let example = find(unit.kind.example_unit()).expect("the example's unit is listed");
            assert_eq!(example.kind, unit.kind, "{}", unit.kind);
        }
    }
}
