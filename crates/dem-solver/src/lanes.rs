//! Sixteen or eight numbers side by side, on the widest instructions that the processor has.
//!
//! [`Simd`] represents an instruction set that is known to be there. A function that takes one
//! is compiled for each set, if it is inlined down to the dispatch.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use fearless_simd::f32x16;
use fearless_simd::prelude::*;

/// Numbers handled together.
pub(crate) const LANES: usize = 16;

/// Numbers handled together where few groups of sixteen would be full.
pub(crate) const HALF: usize = LANES / 2;

/// The lanes of a half, numbered.
pub(crate) const NUMBERS: [u32; HALF] = [0, 1, 2, 3, 4, 5, 6, 7];

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

/// Makes a buffer at least so long.
#[inline(always)]
pub(crate) fn make_room<T: Clone + Default>(buffer: &mut Vec<T>, room: usize) {
    if buffer.len() < room {
        buffer.resize(room, T::default());
    }
}

/// Writes the numbers that a mask keeps behind the `n` that are there; returns how many there are then. The buffer
/// must have room for a whole register behind the `n`.
#[inline(always)]
pub(crate) fn keep<S: Simd, V: SimdBase<S>>(
    kept: &mut [V::Element],
    n: usize,
    numbers: V,
    mask: V::Mask,
) -> usize
where
    V::Mask: SimdMask<S>,
{
    numbers.compress(mask).store_slice(&mut kept[n..n + V::LEN]);
    n + mask.to_bitmask().count_ones() as usize
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

#[inline(always)]
pub(crate) fn stored(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}
