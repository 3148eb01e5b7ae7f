//! Overlaps of grains at rest, at which cases start.

use crate::model::{Contact, Model};
use contact_law::linear_cohesion;

/// Attraction of a contact of a reduced radius and an overlap (m), N.
pub(crate) fn attraction(contact: &Contact, reduced_radius: f64, overlap: f64) -> f64 {
    let area = linear_cohesion::contact_area(reduced_radius, overlap);
    contact.attraction_n + contact.cohesion_energy_density_j_m3 * area
}

/// Overlap (m) at which a contact carries a load (N) beside its attraction, by bisection: the elastic force grows faster than the
/// attraction.
fn overlap_under(contact: &Contact, young: f64, reduced_radius: f64, load: f64) -> f64 {
    let excess = |d: f64| {
        let elastic = 4.0 / 3.0 * young * (reduced_radius * d).sqrt() * d;
        elastic - attraction(contact, reduced_radius, d) - load
    };
    let (mut low, mut high) = (0.0, reduced_radius);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if excess(middle) > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}

/// Overlap of a sphere at rest on the wall under an acceleration (m/s²) normal to it, m.
pub(crate) fn resting_overlap(model: &Model, gravity: f64) -> f64 {
    let young = model.moduli()[1].young;
    overlap_under(
        &model.contacts[1],
        young,
        model.radius_m,
        model.mass() * gravity,
    )
}

/// Overlap of two grains that attract each other, m.
pub(crate) fn neck_overlap(model: &Model) -> f64 {
    let young = model.moduli()[0].young;
    overlap_under(&model.contacts[0], young, 0.5 * model.radius_m, 0.0)
}

/// Speed at which a sphere leaves such a neck at half of its speed if nothing damps it, m/s.
pub(crate) fn neck_speed(model: &Model, overlap: f64) -> f64 {
    let (contact, reduced) = (&model.contacts[0], 0.5 * model.radius_m);
    let area = linear_cohesion::contact_area(reduced, overlap);
    let pull = contact.attraction_n * overlap
        + 0.5 * contact.cohesion_energy_density_j_m3 * area * overlap;
    let elastic =
        8.0 / 15.0 * model.moduli()[0].young * (reduced * overlap).sqrt() * overlap * overlap;
    // m v²/2 is four thirds of the work of parting: a quarter of the energy is left.
    (8.0 / 3.0 * (pull - elastic).max(0.0) / model.mass()).sqrt()
}
