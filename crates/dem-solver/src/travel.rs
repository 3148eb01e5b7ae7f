//! Ways in single precision, on the safe side.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

/// Travel above which a contact wakes that touches, m.
pub(crate) const TOUCHES: f32 = f32::NEG_INFINITY;

/// The same of one that has not been looked at, m: below all travels, and still a number when it is lowered.
pub(crate) const UNKNOWN: f32 = -1e30;

/// A length in single precision, never shorter than the given one, so that a sum of many ways
/// that are short against it is not too short either.
#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    reason = "the loss is made good by the factor"
)]
pub(crate) fn rounded_up(length: f64) -> f32 {
    (length * (1.0 + 2.4e-7)) as f32
}

/// A limit of the travel lowered by what is used up, and by the rounding of doing so, m.
pub(crate) fn lowered(limit: f32, travel: f32) -> f32 {
    limit - travel - f32::EPSILON * (limit.abs() + travel)
}
