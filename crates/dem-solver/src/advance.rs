//! One step of all bodies, by the scheme that they need, on as many threads as there are.

use crate::bodies::BodySlices;
use crate::integrate::{ROOM, Surroundings, advance_bodies};
use crate::spheres::motion::advance_spheres;
use crate::template::Template;
use fearless_simd::Level;

/// Moves all bodies by one step and returns the longest way of a centre of mass since the last broad
/// phase, m; infinite if a travel is not a finite number. On a thread of a pool the halves of the bodies are
/// moved at the same time.
pub(crate) fn advance(
    level: Level,
    in_pool: bool,
    bodies: BodySlices<'_>,
    templates: &[Template],
    around: &Surroundings,
) -> f32 {
    // The largest of some numbers leaves out what is not a number; their sum does not.
    let (longest, sum) = if in_pool {
        advance_halves(level, bodies, templates, around)
    } else {
        advance_slices(level, bodies, templates, around)
    };
    if sum.is_finite() {
        longest
    } else {
        f32::INFINITY
    }
}

/// Longest way of a centre of mass and sum of all travels, m; each half on a thread of its own.
fn advance_halves(
    level: Level,
    bodies: BodySlices<'_>,
    templates: &[Template],
    around: &Surroundings,
) -> (f32, f32) {
    if bodies.len() <= 8 * ROOM {
        return advance_slices(level, bodies, templates, around);
    }
    let middle = bodies.len() / 2;
    let (low, high) = bodies.split_at(middle);
    let (a, b) = rayon::join(
        || advance_halves(level, low, templates, around),
        || advance_halves(level, high, templates, around),
    );
    (a.0.max(b.0), a.1 + b.1)
}

/// Longest way of a centre of mass and sum of all travels, m.
fn advance_slices(
    level: Level,
    mut bodies: BodySlices<'_>,
    templates: &[Template],
    around: &Surroundings,
) -> (f32, f32) {
    if bodies.spheres.is_empty() {
        advance_bodies(level, &mut bodies, templates, around)
    } else {
        advance_spheres(level, &mut bodies, templates, around)
    }
}
