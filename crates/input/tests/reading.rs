//! Reading quantities with units and scalars with ranges.

use std::f64::consts::PI;

use input::quantity::{
    Angle, AngularSpeed, Density, Error, Fraction, Frequency, FrictionCoefficient, Kind, Length,
    Mass, PoissonRatio, PositiveCount, Pressure, Restitution, Speed, Time,
};
use proptest::prelude::*;

/// Conversions by powers of ten round once and meet the literal here to the last bit; those by pi
/// are the product that `f64::to_radians` forms.
#[test]
fn quantities_of_the_published_study_read_as_their_si_values() {
    assert_eq!(Length::parse("0.45 mm").map(Length::si), Ok(0.45e-3));
    assert_eq!(Length::parse("140 mm").map(Length::si), Ok(0.140));
    assert_eq!(Length::parse("46mm").map(Length::si), Ok(0.046));
    assert_eq!(Length::parse("1.5e1 um").map(Length::si), Ok(15e-6));
    assert_eq!(Pressure::parse("4.01 MPa").map(Pressure::si), Ok(4.01e6));
    assert_eq!(Density::parse("917 kg/m3").map(Density::si), Ok(917.0));
    assert_eq!(Density::parse("0.917 g/cm3").map(Density::si), Ok(917.0));
    assert_eq!(Mass::parse("94.5 mg").map(Mass::si), Ok(94.5e-6));
    assert_eq!(Time::parse("2 s").map(Time::si), Ok(2.0));
    assert_eq!(Time::parse("1.5 min").map(Time::si), Ok(90.0));
    assert_eq!(Speed::parse("-25 mm/s").map(Speed::si), Ok(-0.025));
    assert_eq!(Frequency::parse("50 Hz").map(Frequency::si), Ok(50.0));
    let angle = Angle::parse("38.87 deg").map(Angle::si);
    assert_eq!(angle, Ok(38.87_f64.to_radians()));
    assert_eq!(AngularSpeed::parse("30 rpm").map(AngularSpeed::si), Ok(PI));
}

#[test]
fn a_bare_number_is_refused_with_the_accepted_units() {
    let text = Length::parse("0.45").expect_err("no unit").to_string();
    assert!(text.contains("has no unit"), "{text}");
    assert!(text.contains("m, cm, mm, um"), "{text}");
}

#[test]
fn a_unit_of_another_kind_is_refused_with_both_kinds() {
    let error = Length::parse("10 rpm").expect_err("not a length");
    assert!(
        matches!(
            error,
            Error::WrongKind {
                found: Kind::AngularSpeed,
                expected: Kind::Length,
                ..
            }
        ),
        "{error}"
    );
    let text = error.to_string();
    assert!(text.contains("is an angular speed"), "{text}");
    assert!(text.contains("a length is expected"), "{text}");
}

#[test]
fn text_that_is_no_decimal_number_is_refused() {
    for text in [
        "", "mm", "-", ".", "NaN mm", "inf mm", "0,45 mm", "1.2.3 mm", "e3 mm", "--1 mm",
    ] {
        let error = Length::parse(text).expect_err(text);
        assert!(matches!(error, Error::NoNumber { .. }), "{text}: {error}");
        assert!(error.to_string().contains("is not a length"), "{error}");
    }
}

#[test]
fn an_unknown_unit_is_refused_and_capitals_count() {
    for text in ["4 mPa", "4 mpa", "4 psi", "4 Pa Pa"] {
        let error = Pressure::parse(text).expect_err(text);
        assert!(
            matches!(error, Error::UnknownUnit { .. }),
            "{text}: {error}"
        );
    }
}

#[test]
fn values_that_cannot_be_meant_are_refused() {
    assert!(Mass::parse("0 kg").is_err(), "no mass");
    assert!(Density::parse("-1 kg/m3").is_err(), "negative density");
    assert!(Time::parse("-1 s").is_err(), "negative duration");
    assert!(Time::parse("0 s").is_ok(), "no duration is a duration");
    assert!(Length::parse("1e999 mm").is_err(), "too large a number");
    assert!(Length::from_si(f64::NAN).is_err(), "not a number");
    let zero = Length::parse("0 mm").expect("a coordinate may be zero");
    let text = zero.require_positive("the radius").expect_err("zero");
    assert_eq!(
        text.to_string(),
        "the radius must be more than 0, not 0 m: check the sign and the unit"
    );
}

#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Drum {
    radius: Length,
    restitution: Restitution,
    seeds: PositiveCount,
}

fn drum(radius: &str, restitution: &str, seeds: &str) -> Result<Drum, String> {
    let text = format!("radius = {radius}\nrestitution = {restitution}\nseeds = {seeds}\n");
    toml::from_str(&text).map_err(|error| error.to_string())
}

#[test]
fn a_file_is_read_and_its_errors_name_the_line() {
    let good = drum("\"70 mm\"", "0.06", "1200").expect("a good file");
    assert_eq!(good.radius.si(), 0.07);
    assert_eq!(good.restitution.get(), 0.06);
    assert_eq!(good.seeds.get(), 1200);
    for (radius, restitution, seeds, line, message) in [
        ("0.07", "0.06", "1", "line 1", "0.07 has no unit"),
        ("7", "0.06", "1", "line 1", "7 has no unit"),
        ("\"7 s\"", "0.06", "1", "line 1", "\"7 s\" is a time"),
        ("\"7 mm\"", "6", "1", "line 2", "not 6: give the ratio"),
        ("\"7 mm\"", "nan", "1", "line 2", "must be finite"),
        ("\"7 mm\"", "0.06", "0", "line 3", "1 or more, not 0"),
        ("\"7 mm\"", "0.06", "-3", "line 3", "1 or more, not -3"),
        ("\"7 mm\"", "0.06", "1.5", "line 3", "1.5"),
    ] {
        let text = drum(radius, restitution, seeds).expect_err(message);
        assert!(text.contains(line), "{text}");
        assert!(text.contains(message), "{text}");
    }
}

#[test]
fn scalars_accept_their_range_and_nothing_beside_it() {
    assert!(Restitution::new(0.0).is_ok() && Restitution::new(1.0).is_ok());
    assert!(Restitution::new(-1e-9).is_err() && Restitution::new(1.0 + 1e-9).is_err());
    assert!(FrictionCoefficient::new(0.0).is_ok() && FrictionCoefficient::new(2.5).is_ok());
    assert!(FrictionCoefficient::new(-1e-9).is_err());
    assert!(PoissonRatio::new(-0.999).is_ok() && PoissonRatio::new(0.5).is_ok());
    assert!(PoissonRatio::new(-1.0).is_err() && PoissonRatio::new(0.5 + 1e-9).is_err());
    assert!(Fraction::new(0.0).is_ok() && Fraction::new(1.0).is_ok());
    assert!(Fraction::new(1.1).is_err() && Fraction::new(-0.1).is_err());
    assert!(PositiveCount::new(1).is_ok() && PositiveCount::new(0).is_err());
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(Restitution::new(value).is_err(), "{value}");
        assert!(FrictionCoefficient::new(value).is_err(), "{value}");
        assert!(PoissonRatio::new(value).is_err(), "{value}");
        assert!(Fraction::new(value).is_err(), "{value}");
    }
}

proptest! {
    /// Rust prints the shortest digits that read back to the same number, so nothing is lost.
    #[test]
    fn displayed_quantities_read_back_to_the_same_bits(value in any::<f64>()) {
        prop_assume!(value.is_finite());
        let length = Length::from_si(value).expect("finite");
        prop_assert_eq!(Length::parse(&length.to_string()).map(Length::si), Ok(value));
        let speed = AngularSpeed::from_si(value).expect("finite");
        prop_assert_eq!(speed.to_string().parse().map(AngularSpeed::si), Ok(value));
    }

    #[test]
    fn serialised_quantities_and_scalars_read_back_equal(value in 0.0_f64..=1.0) {
        let angle = Angle::from_si(value).expect("finite");
        let text = serde_json::to_string(&angle).expect("text");
        prop_assert_eq!(serde_json::from_str::<Angle>(&text).expect("the same text"), angle);
        let restitution = Restitution::new(value).expect("in range");
        let text = serde_json::to_string(&restitution).expect("a number");
        let read: Restitution = serde_json::from_str(&text).expect("the same number");
        // serde_json reads decimals to within one unit in the last place.
        prop_assert!((read.get() - value).abs() <= f64::EPSILON * value);
    }

    /// One division rounds by at most half a unit in the last place, and so does the literal.
    #[test]
    fn millimetres_are_a_thousandth_of_metres(value in -1e6_f64..1e6) {
        let in_mm = Length::parse(&format!("{value} mm")).expect("a length").si();
        let in_m = Length::parse(&format!("{value} m")).expect("a length").si();
        prop_assert!((in_mm * 1000.0 - in_m).abs() <= 2.0 * f64::EPSILON * in_m.abs());
    }

    #[test]
    fn no_text_makes_the_reader_panic(text in ".*") {
        let _ = Length::parse(&text);
    }
}
