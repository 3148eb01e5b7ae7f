//! Rows of numbers as columns, and the other way round, in registers.
//!
//! What a body is lies in a row of memory; the law wants the same number of eight contacts side by side.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use fearless_simd::f64x8;
use fearless_simd::prelude::*;

/// Contacts whose numbers change from rows to columns together.
pub(crate) const GROUP: usize = 8;

/// Eight rows of eight numbers as columns.
///
/// Each round deals the numbers like a pack of cards cut in the middle: in the 64 places, written as (row, place in
/// the row), every bit of the number of a place moves up by one. After three rounds the two have changed sides.
#[inline(always)]
pub(crate) fn transposed<S: Simd>(rows: [f64x8<S>; 8]) -> [f64x8<S>; 8] {
    let mut all = rows;
    for _ in 0..3 {
        let [a, b, c, d, e, f, g, h] = all;
        let (ae, be) = (a.interleave(e), b.interleave(f));
        let (cg, dh) = (c.interleave(g), d.interleave(h));
        all = [ae.0, ae.1, be.0, be.1, cg.0, cg.1, dh.0, dh.1];
    }
    all
}

/// Four rows of two by four numbers each, those of the contacts 0 and 1, 2 and 3, 4 and 5, 6 and 7, as four columns.
#[inline(always)]
pub(crate) fn four_columns<S: Simd>(rows: [f64x8<S>; 4]) -> [f64x8<S>; 4] {
    let mut all = rows;
    for _ in 0..2 {
        let [a, b, c, d] = all;
        let (ab, cd) = (a.deinterleave(b), c.deinterleave(d));
        all = [ab.0, cd.0, ab.1, cd.1];
    }
    all
}

#[cfg(test)]
mod tests {
    use super::{four_columns, transposed};
    use fearless_simd::prelude::*;
    use fearless_simd::{Level, dispatch, f64x8};

    /// Numbers that say where they stand, 10 row + place, land in the row of their place and the place of their row.
    #[test]
    fn rows_become_columns() {
        dispatch!(Level::new(), simd => {
            let number = |row: usize, place: usize| (10 * row + place) as f64;
            let rows = std::array::from_fn(|r| f64x8::from_fn(simd, |p| number(r, p)));
            for (c, column) in transposed(rows).iter().enumerate() {
                let expected = f64x8::from_fn(simd, |k| number(k, c));
                assert_eq!(column.as_slice(), expected.as_slice());
            }
            // Two rows of four in one register: contact 2 r, then 2 r + 1.
            let rows = std::array::from_fn(|r| f64x8::from_fn(simd, |p| number(2 * r + p / 4, p % 4)));
            for (c, column) in four_columns(rows).iter().enumerate() {
                let expected = f64x8::from_fn(simd, |k| number(k, c));
                assert_eq!(column.as_slice(), expected.as_slice());
            }
        });
    }
}
