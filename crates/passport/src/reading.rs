//! Reading a passport, with limits that keep the self-test finite.

use crate::Error;
use crate::folder::Passport;
use crate::model::Model;
use crate::reference::steps;
use crate::small_cases::cases;
use contact_law::Material;

/// Most steps of a small case: some hundred times those of common grains.
const MOST_STEPS: u64 = 20_000_000;

/// Reads a passport.
///
/// # Errors
///
/// A text that is none, and a value with which no case can be computed.
pub fn read_passport(text: &str) -> Result<Passport, Error> {
    let passport: Passport =
        serde_json::from_str(text).map_err(|source| Error::Json(source.to_string()))?;
    let wrong = |what: String| Err(Error::Json(what));
    for (name, value, low, high) in limits(&passport.model) {
        if !(low..=high).contains(&value) {
            return wrong(format!(
                "{name} is {value}, and must be {low:e} to {high:e}"
            ));
        }
    }
    for (place, material) in ["grain", "wall"].iter().zip(&passport.model.materials) {
        if let Err(source) = Material::new(material.poisson_ratio, material.shear_modulus) {
            return wrong(format!("the material of the {place}: {source}"));
        }
    }
    for row in &passport.expected {
        if !(row.value.is_finite() && row.band.is_finite() && row.band > 0.0) {
            let (case, quantity) = (&row.case, &row.quantity);
            return wrong(format!(
                "{case} {quantity} is expected at {} +- {}, and must be finite with a band above 0",
                row.value, row.band
            ));
        }
    }
    let longest = cases(&passport.model).into_iter().map(|case| {
        let last = case.times.iter().copied().fold(0.0, f64::max);
        (case.name, steps(last, case.time_step))
    });
    match longest.into_iter().find(|(_, n)| *n > MOST_STEPS) {
        Some((name, n)) => wrong(format!(
            "the case {name} takes {n} steps, more than {MOST_STEPS}: the grains are too stiff"
        )),
        None => Ok(passport),
    }
}

/// Values of a model with their limits, those of a scene.
fn limits(model: &Model) -> Vec<(String, f64, f64, f64)> {
    let mut limits = vec![
        ("radius_m".to_owned(), model.radius_m, 1e-6, 1.0),
        ("density_kg_m3".to_owned(), model.density_kg_m3, 1e-3, 1e6),
        ("gravity_m_s2".to_owned(), model.gravity_m_s2, 1e-3, 1e3),
    ];
    for (place, contact) in ["grains", "wall"].iter().zip(&model.contacts) {
        let each = [
            ("restitution", contact.restitution, 0.0, 1.0),
            ("static_friction", contact.static_friction, 0.0, 100.0),
            ("rolling_friction", contact.rolling_friction, 0.0, 100.0),
            ("attraction_n", contact.attraction_n, 0.0, 1e6),
            (
                "cohesion_energy_density_j_m3",
                contact.cohesion_energy_density_j_m3,
                0.0,
                1e12,
            ),
        ];
        limits.extend(
            each.map(|(name, value, low, high)| (format!("{name} of {place}"), value, low, high)),
        );
    }
    limits
}
