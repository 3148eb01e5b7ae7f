//! Distances moved, in single precision and rounded to the safe side.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

/// Travel above which a touching contact wakes, m.
pub(crate) const TOUCHES: f32 = f32::NEG_INFINITY;

/// The same for one not yet looked at, m: below all travels, and finite when it is lowered.
pub(crate) const UNKNOWN: f32 = -1e30;

/// A length in single precision, never shorter than the given one: a sum of many small distances would otherwise lose each of them
/// to rounding, and a list would outlive its limit.
#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    reason = "the loss is made good by the factor"
)]
pub(crate) fn rounded_up(length: f64) -> f32 {
    (length * (1.0 + 2.4e-7)) as f32
}

/// A limit of the travel lowered by the travel used up, and by the rounding of this difference, m.
pub(crate) fn lowered(limit: f32, travel: f32) -> f32 {
    limit - travel - f32::EPSILON * (limit.abs() + travel)
}
