//! Factors that other codes are known to give, and what such a code then takes.

use crate::convention::{Change, Convention, NOTHING, Value};
use crate::model::Model;
use contact_law::hertz_mindlin::damping_ratio;

/// Grains and wall of a [`Change::Factor`].
const GRAINS: [bool; 2] = [true, false];
const WALL: [bool; 2] = [false, true];

/// Known ways to a factor: the factor and what the other code then takes.
pub(crate) fn known_readings(convention: &Convention, model: &Model) -> Vec<(f64, String)> {
    let Change::Factor { value, at, .. } = convention.change else {
        return Vec::new();
    };
    let known: Vec<(f64, &str)> = match value {
        Value::Rolling => rolling_readings(at),
        Value::Restitution => restitution_readings(at, model),
        Value::Friction => friction_readings(at, model),
        Value::Modulus => modulus_readings(at, model),
        Value::Cohesion => vec![
            (NOTHING, "there is no attraction"),
            (
                2.0,
                "the attraction takes the radius, not the reduced radius",
            ),
            (0.5, "the attraction takes half of the reduced radius"),
        ],
        Value::Derived => derived_readings(convention, model),
    };
    known
        .into_iter()
        .map(|(factor, words)| (factor, words.to_owned()))
        .collect()
}

fn restitution_readings(at: [bool; 2], model: &Model) -> Vec<(f64, &'static str)> {
    let [grains, wall] = model.contacts.each_ref().map(|c| c.restitution);
    let ratio = |of: f64, over: f64| damping_ratio(of) / damping_ratio(over);
    let own = match at {
        WALL => vec![
            (
                ratio(grains, wall),
                "your code takes the restitution of two grains",
            ),
            (
                ratio(0.5 * (wall + grains), wall),
                "your code takes the mean restitution of both contacts",
            ),
            (
                0.5_f64.sqrt(),
                "the wall counts as a sphere of the same mass",
            ),
        ],
        GRAINS => vec![
            (
                2.0_f64.sqrt(),
                "the dashpot takes the mass of a grain, not the reduced mass",
            ),
            (
                ratio(wall, grains),
                "your code takes the restitution at the wall",
            ),
        ],
        _ => Vec::new(),
    };
    let formula = [
        (1.2_f64.sqrt(), "the dashpot has no factor sqrt(5/6)"),
        (
            (5.0_f64 / 6.0).sqrt(),
            "the dashpot has the factor sqrt(5/6) twice",
        ),
        (NOTHING, "there is no dashpot"),
    ];
    own.into_iter().chain(formula).collect()
}

fn friction_readings(at: [bool; 2], model: &Model) -> Vec<(f64, &'static str)> {
    let [g, w] = model.contacts.each_ref().map(|c| c.static_friction);
    let own = match at {
        WALL if w > 0.0 => vec![
            (g / w, "your code takes the friction of two grains"),
            (
                0.5 * (g + w) / w,
                "your code takes the mean friction of both contacts",
            ),
            (
                (g / w).sqrt(),
                "your code takes the geometric mean of the friction of both contacts",
            ),
        ],
        GRAINS if g > 0.0 => vec![(w / g, "your code takes the friction at the wall")],
        _ => Vec::new(),
    };
    own.into_iter()
        .chain([(NOTHING, "there is no friction")])
        .collect()
}

fn modulus_readings(at: [bool; 2], model: &Model) -> Vec<(f64, &'static str)> {
    let nu = model.materials[0].poisson_ratio;
    let mut readings = vec![
        (
            2.0 * (1.0 + nu),
            "Young's modulus went in as the shear modulus",
        ),
        (
            0.5 / (1.0 + nu),
            "the shear modulus went in as Young's modulus",
        ),
        (2.0, "one of the two sides counts as rigid"),
    ];
    if at == WALL {
        let words =
            "the wall counts as a sphere of the same radius: the reduced radius is R/2, not R";
        readings.push((0.5_f64.sqrt(), words));
    }
    readings
}

fn rolling_readings(at: [bool; 2]) -> Vec<(f64, &'static str)> {
    let own: &[(f64, &'static str)] = match at {
        GRAINS => &[
            (
                2.0,
                "your code takes the radius as lever arm, not the reduced radius R/2",
            ),
            (
                4.0,
                "your code takes the diameter as lever arm, not the reduced radius R/2",
            ),
            (
                0.5,
                "your code takes half of the reduced radius as lever arm",
            ),
        ],
        WALL => &[
            (
                0.5,
                "the wall counts as a sphere of the same radius: the lever arm is R/2, not R",
            ),
            (
                2.0,
                "your code takes the diameter as lever arm, not the radius",
            ),
        ],
        _ => &[
            (
                0.5,
                "your code takes the radius where the coefficient was stated for the diameter",
            ),
            (
                2.0,
                "your code takes the diameter as lever arm, not the radius",
            ),
        ],
    };
    let off = (NOTHING, "rolling resistance is off");
    own.iter().copied().chain([off]).collect()
}

fn derived_readings(convention: &Convention, model: &Model) -> Vec<(f64, &'static str)> {
    let moduli = &model.moduli()[0];
    let equal = 2.0 * moduli.young / (8.0 * moduli.shear);
    match convention.name {
        "tangential-damping" => vec![
            (NOTHING, "there is no tangential dashpot"),
            (
                equal.sqrt(),
                "the tangential dashpot is that of the normal direction",
            ),
        ],
        _ => vec![
            (
                equal,
                "the tangential stiffness is that of the normal direction",
            ),
            (
                2.0 / 7.0 * equal,
                "the tangential stiffness is 2/7 of that of the normal direction",
            ),
        ],
    }
}
