//! The order of the bodies in memory.
//!
//! A contact reads both of its bodies. In a bed that has mixed, neighbours stand anywhere in memory, and a large world
//! waits for most of them; sorted by place, they have been read a moment ago.

use super::World;
use crate::error::Error;
use nalgebra::Vector3;

impl World {
    /// Sorts the bodies by where they are, so that neighbours lie together in memory; for each place the place in which
    /// its body stood before.
    ///
    /// Nothing else changes, but everything that counts bodies by place must follow: bonds, above all. Forces are summed
    /// in the order of the bodies, and so the steps that follow differ from those of an unsorted world by rounding. It
    /// costs as much as some steps, and pays from some thousands of bodies on.
    ///
    /// # Errors
    ///
    /// A body whose state is no longer finite.
    pub fn sort_bodies(&mut self) -> Result<Vec<usize>, Error> {
        self.check_finite()?;
        let positions = self.bodies.position.iter();
        let places: Vec<_> = positions.map(|p| self.between_sides(p)).collect();
        let order = by_place(&places, &self.radii);
        if !order.is_sorted() {
            self.reorder(&order)?;
        }
        Ok(order)
    }

    /// Takes bodies out between two steps; the others keep their contacts and their order, and move up to fill the gaps.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuch`] for a body that does not exist; a body whose state is no longer finite.
    pub fn remove(&mut self, bodies: &[usize]) -> Result<(), Error> {
        let count = self.bodies.len();
        if let Some(&index) = bodies.iter().find(|&&body| body >= count) {
            let what = "body";
            return Err(Error::NoSuch { what, index, count });
        }
        if bodies.is_empty() {
            return Ok(());
        }
        self.check_finite()?;
        let mut places: Vec<Option<usize>> = vec![Some(0); count];
        for &body in bodies {
            places[body] = None;
        }
        let kept: Vec<usize> = (0..count).filter(|&k| places[k].is_some()).collect();
        for (place, &body) in kept.iter().enumerate() {
            places[body] = Some(place);
        }
        let bodies = self.bodies.reordered(&kept);
        let snapshot = self.snapshot_with(bodies).without(&places);
        self.radii = kept.iter().map(|&k| self.radii[k]).collect();
        self.take_up(snapshot)
    }

    /// Puts the bodies into another order: into each place the body of a place of now.
    ///
    /// # Errors
    ///
    /// [`Error::NoOrder`] if a place is named twice or not at all; a body whose state is no longer finite.
    pub fn reorder(&mut self, order: &[usize]) -> Result<(), Error> {
        self.check_finite()?;
        let bodies = self.bodies.len();
        let places = places(order, bodies).ok_or(Error::NoOrder { bodies })?;
        let bodies = self.bodies.reordered(order);
        let snapshot = self.snapshot_with(bodies).renumbered(&places);
        self.radii = order.iter().map(|&k| self.radii[k]).collect();
        self.take_up(snapshot)
    }
}

/// Where each of so many bodies goes; none if an order names one of them twice or not at all.
fn places(order: &[usize], bodies: usize) -> Option<Vec<usize>> {
    let mut places = vec![usize::MAX; bodies];
    for (place, &body) in order.iter().enumerate() {
        *places.get_mut(body).filter(|p| **p == usize::MAX)? = place;
    }
    (order.len() == bodies).then_some(places)
}

/// The bodies by cells as wide as a body, slice by slice along the longest side of the bed, then row by row; as they are
/// within a cell. Positions and bounding radii in m.
fn by_place(positions: &[Vector3<f64>], radii: &[f64]) -> Vec<usize> {
    let start = Vector3::repeat(f64::INFINITY);
    let low = positions.iter().fold(start, |low, p| low.inf(p));
    let high = positions.iter().fold(-start, |high, p| high.sup(p));
    let sides = high - low;
    let mut axes = [0, 1, 2];
    axes.sort_by(|&a, &b| sides[b].total_cmp(&sides[a]));
    let width = 2.0 * radii.iter().sum::<f64>() / radii.len().max(1) as f64;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "not negative; what lies too far for the number of a cell is in the last"
    )]
    let cell = |k: usize| axes.map(|a| ((positions[k][a] - low[a]) / width) as u32);
    let mut order: Vec<usize> = (0..positions.len()).collect();
    order.sort_by_cached_key(|&k| cell(k));
    order
}

#[cfg(test)]
mod tests {
    use super::{by_place, places};
    use nalgebra::Vector3;

    /// Six bodies of 1 m in two slices of a bed that is longest along z.
    #[test]
    fn slices_follow_the_longest_side_and_rows_the_next() {
        let at = |x: f64, y: f64, z: f64| Vector3::new(x, y, z);
        let positions = [
            at(0.0, 1.5, 4.9),
            at(0.0, 0.0, 0.2),
            at(1.2, 1.5, 0.1),
            at(0.0, 1.5, 0.3),
            at(0.1, 1.6, 0.0),
            at(0.0, 0.0, 5.0),
        ];
        let order = by_place(&positions, &[0.5; 6]);
        assert_eq!(order, [1, 3, 4, 2, 0, 5], "z, then y, then x");
    }

    #[test]
    fn an_order_names_each_body_once() {
        assert_eq!(places(&[2, 0, 1], 3), Some(vec![1, 2, 0]));
        for wrong in [&[0, 0, 1][..], &[0, 1], &[0, 1, 2, 2], &[0, 1, 3]] {
            assert_eq!(places(wrong, 3), None, "{wrong:?}");
        }
    }
}
