//! Pairs of points that lie near each other.

use nalgebra::Vector3;

/// Extra reach of the list, radii: it stays valid until a point has moved half of it.
const SKIN: f64 = 0.5;

/// A list of near pairs that renews itself when the points have moved.
#[derive(Debug, Default)]
pub(crate) struct Neighbours {
    /// Pairs of indices, rising.
    pairs: Vec<(u32, u32)>,
    /// Points when the pairs were listed.
    listed_at: Vec<Vector3<f64>>,
}

impl Neighbours {
    /// All pairs nearer than `reach` (radii), and some a little farther.
    pub(crate) fn within(&mut self, points: &[Vector3<f64>], reach: f64) -> &[(u32, u32)] {
        let far = (0.5 * SKIN).powi(2);
        let moved = |(old, new): (&Vector3<f64>, &Vector3<f64>)| (old - new).norm_squared() > far;
        if self.listed_at.len() != points.len() || self.listed_at.iter().zip(points).any(moved) {
            self.list(points, reach + SKIN);
        }
        &self.pairs
    }

    /// Lists the pairs by sweeping along x.
    fn list(&mut self, points: &[Vector3<f64>], reach: f64) {
        self.listed_at.clear();
        self.listed_at.extend_from_slice(points);
        self.pairs.clear();
        let mut order: Vec<u32> = (0..).take(points.len()).collect();
        let at = |i: u32| &points[i as usize];
        order.sort_by(|&a, &b| at(a).x.total_cmp(&at(b).x));
        for (place, &i) in order.iter().enumerate() {
            for &j in &order[place + 1..] {
                if at(j).x - at(i).x > reach {
                    break;
                }
                if (at(i) - at(j)).norm_squared() < reach * reach {
                    self.pairs.push((i.min(j), i.max(j)));
                }
            }
        }
        self.pairs.sort_unstable();
    }
}

#[cfg(test)]
mod tests {
    use super::Neighbours;
    use nalgebra::Vector3;
    use probability::random_stream::Stream;

    /// The sweep finds the same near pairs as the comparison of all with all, also after moves.
    #[test]
    fn no_near_pair_is_missing_while_points_move() {
        let mut stream = Stream::new(3, "neighbours");
        let mut coordinate = move |scale: f64| scale * stream.between(-1.0, 1.0);
        let mut points: Vec<_> = (0..80)
            .map(|_| Vector3::from_fn(|_, _| coordinate(5.0)))
            .collect();
        let mut neighbours = Neighbours::default();
        for _ in 0..20 {
            let listed = neighbours.within(&points, 2.0).to_vec();
            for j in 0_u32..80 {
                for i in 0..j {
                    let near = (points[i as usize] - points[j as usize]).norm() < 2.0;
                    assert!(
                        !near || listed.contains(&(i, j)),
                        "pair {i}, {j} is missing"
                    );
                }
            }
            for point in &mut points {
                *point += Vector3::from_fn(|_, _| coordinate(0.1));
            }
        }
    }
}
