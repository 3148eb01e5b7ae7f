//! Rows of numbers as columns, and the other way round, in registers.
//!
//! What a body is lies in a row of memory; the law wants the same number of eight contacts side by side.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use fearless_simd::prelude::*;
use fearless_simd::{f64x2, f64x4, f64x8};
use nalgebra::Vector3;

/// Three coordinates and a fourth number that goes along, so that they are read and written together.
pub(crate) type Row = [f64; 4];

#[inline(always)]
pub(crate) fn row(vector: &Vector3<f64>, beside: f64) -> Row {
    [vector.x, vector.y, vector.z, beside]
}

#[inline(always)]
pub(crate) fn vector(row: &Row) -> Vector3<f64> {
    Vector3::new(row[0], row[1], row[2])
}

/// Contacts whose numbers change from rows to columns together.
pub(crate) const GROUP: usize = 8;

/// Eight rows of eight numbers as columns.
#[inline(always)]
pub(crate) fn transposed<S: Simd>(rows: [f64x8<S>; 8]) -> [f64x8<S>; 8] {
    if S::f64s::LEN == GROUP {
        return dealt(rows);
    }
    let [a, b, c, d, e, f, g, h] = rows.map(SimdSplit::split);
    let upper = [
        four_by_four([a.0, b.0, c.0, d.0]),
        four_by_four([a.1, b.1, c.1, d.1]),
    ];
    let lower = [
        four_by_four([e.0, f.0, g.0, h.0]),
        four_by_four([e.1, f.1, g.1, h.1]),
    ];
    std::array::from_fn(|k| upper[k / 4][k % 4].combine(lower[k / 4][k % 4]))
}

/// Eight rows of four numbers as columns.
#[inline(always)]
pub(crate) fn four_columns<S: Simd>(rows: [f64x4<S>; 8]) -> [f64x8<S>; 4] {
    let [a, b, c, d, e, f, g, h] = rows;
    if S::f64s::LEN < GROUP {
        let (upper, lower) = (four_by_four([a, b, c, d]), four_by_four([e, f, g, h]));
        return std::array::from_fn(|k| upper[k].combine(lower[k]));
    }
    let mut all = [a.combine(b), c.combine(d), e.combine(f), g.combine(h)];
    for _ in 0..2 {
        let [a, b, c, d] = all;
        let (ab, cd) = (a.deinterleave(b), c.deinterleave(d));
        all = [ab.0, cd.0, ab.1, cd.1];
    }
    all
}

/// [`transposed`] for registers of eight numbers.
///
/// Each round deals the numbers like a pack of cards cut in the middle: in the 64 places, written as (row, place in
/// the row), every bit of the number of a place moves up by one. After three rounds the two have changed sides.
#[inline(always)]
fn dealt<S: Simd>(rows: [f64x8<S>; 8]) -> [f64x8<S>; 8] {
    let mut all = rows;
    for _ in 0..3 {
        let [a, b, c, d, e, f, g, h] = all;
        let (ae, be) = (a.interleave(e), b.interleave(f));
        let (cg, dh) = (c.interleave(g), d.interleave(h));
        all = [ae.0, ae.1, be.0, be.1, cg.0, cg.1, dh.0, dh.1];
    }
    all
}

/// Transposes four rows of four numbers. Each row is split into halves first: in narrow registers it costs most to move a number
/// from one half to the other.
#[inline(always)]
pub(crate) fn four_by_four<S: Simd>(rows: [f64x4<S>; 4]) -> [f64x4<S>; 4] {
    let two_columns = |[a, b, c, d]: [f64x2<S>; 4]| {
        let first = a.zip_low(b).combine(c.zip_low(d));
        (first, a.zip_high(b).combine(c.zip_high(d)))
    };
    let [a, b, c, d] = rows.map(SimdSplit::split);
    let (x, y) = two_columns([a.0, b.0, c.0, d.0]);
    let (z, w) = two_columns([a.1, b.1, c.1, d.1]);
    [x, y, z, w]
}

#[cfg(test)]
mod tests {
    use super::{dealt, four_columns, transposed};
    use fearless_simd::prelude::*;
    use fearless_simd::{Level, dispatch, f64x4, f64x8};

    /// Numbers that say where they stand, 10 row + place, land in the row of their place and the place of their row, on
    /// the widest registers of this processor and on the narrowest.
    #[test]
    fn rows_become_columns() {
        for level in [Level::new(), Level::baseline()] {
            dispatch!(level, simd => assert_transposed(simd));
        }
    }

    fn assert_transposed<S: Simd>(simd: S) {
        let number = |row: usize, place: usize| (10 * row + place) as f64;
        let rows = std::array::from_fn(|r| f64x8::from_fn(simd, |p| number(r, p)));
        // Dealing is right on any registers, if not fast.
        for columns in [transposed(rows), dealt(rows)] {
            for (c, column) in columns.iter().enumerate() {
                let expected = f64x8::from_fn(simd, |k| number(k, c));
                assert_eq!(column.as_slice(), expected.as_slice());
            }
        }
        let rows = std::array::from_fn(|r| f64x4::from_fn(simd, |p| number(r, p)));
        for (c, column) in four_columns(rows).iter().enumerate() {
            let expected = f64x8::from_fn(simd, |k| number(k, c));
            assert_eq!(column.as_slice(), expected.as_slice());
        }
    }
}
