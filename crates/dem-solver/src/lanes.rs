//! Sixteen numbers side by side, on the widest instructions that the processor has.
//!
//! [`Simd`] stands for an instruction set that is known to be there. A function that takes one
//! is compiled for each set, if it is inlined down to the dispatch.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use fearless_simd::f32x16;
use fearless_simd::prelude::*;

/// Numbers handled together.
pub(crate) const LANES: usize = 16;

/// One number in each lane.
pub(crate) type Lanes = [f32; LANES];

/// A vector in each lane.
pub(crate) type Vectors<S> = [f32x16<S>; 3];

/// Numbers in a register.
#[inline(always)]
pub(crate) fn load<S: Simd>(simd: S, lanes: &Lanes) -> f32x16<S> {
    f32x16::from_slice(simd, lanes)
}

/// Vectors in registers.
#[inline(always)]
pub(crate) fn load_vectors<S: Simd>(simd: S, lanes: &[Lanes; 3]) -> Vectors<S> {
    [
        load(simd, &lanes[0]),
        load(simd, &lanes[1]),
        load(simd, &lanes[2]),
    ]
}

/// Component of each vector along a direction.
#[inline(always)]
pub(crate) fn along<S: Simd>(vectors: &Vectors<S>, direction: &[f32; 3]) -> f32x16<S> {
    let last = vectors[2] * direction[2];
    vectors[0].mul_add(direction[0], vectors[1].mul_add(direction[1], last))
}

/// Square of the length of each vector.
#[inline(always)]
pub(crate) fn squares<S: Simd>(vectors: &Vectors<S>) -> f32x16<S> {
    vectors[0] * vectors[0] + vectors[1] * vectors[1] + vectors[2] * vectors[2]
}

/// The positions of the set bits, in rising order.
#[inline(always)]
pub(crate) fn set_bits(mut bits: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits.wrapping_sub(1);
        (lane < 64).then_some(lane)
    })
}
