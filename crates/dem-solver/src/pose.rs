//! How two bodies lay when the list of their spheres was made, and how far they have moved since.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::candidates::{Patch, SLOPE};
use nalgebra::{UnitQuaternion, Vector3, Vector4};

/// Relative pose of a pair when its list was made, rounded by less than the safety distance.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub(crate) struct Pose {
    /// Orientation of j in the frame of i as a unit quaternion: i, j, k, w.
    rotation: [f32; 4],
    /// The patch that decides.
    patch: Patch,
    /// Middle of the patch in the frame of i, m.
    middle: [f32; 3],
    /// Relative motion that the list covers, m; negative when there is no list.
    reach: f32,
}

impl Pose {
    /// Of a pair without a list.
    pub(crate) const NONE: Self = Self {
        rotation: [0.0; 4],
        patch: Patch {
            centre: [0.0; 3],
            radius: 0.0,
        },
        middle: [0.0; 3],
        reach: -1.0,
    };

    /// Rounds a pose, the position of j in the frame of i (m) and its orientation there, whose list covers a motion
    /// of `reach` (m) of a patch.
    #[inline(always)]
    pub(crate) fn new(
        position: &Vector3<f64>,
        rotation: &UnitQuaternion<f64>,
        patch: &Patch,
        reach: f32,
    ) -> Self {
        let middle = position + rotation * Vector3::from(patch.centre.map(f64::from));
        Self {
            rotation: single(&rotation.coords.data.0[0]),
            patch: *patch,
            middle: single(&middle.data.0[0]),
            reach,
        }
    }

    /// Something of the first and the last number: whoever reads it has the whole pose in the cache.
    #[inline(always)]
    pub(crate) fn both_ends(&self) -> u32 {
        self.rotation[0].to_bits() ^ self.reach.to_bits()
    }

    /// Relative motion that the list covers, m; negative when there is no list.
    pub(crate) fn reach(&self) -> f32 {
        self.reach
    }

    /// Relative motion that the list still covers in a later pose, m; negative when there is none, or after a turn larger
    /// than the slope of the patch.
    ///
    /// A sphere at a distance s from the middle of the patch has moved by at most m + t s, with the way m of the middle and the
    /// turn t. One in the patch of radius r has moved by m + t r at most; one beyond it by t (s - r) more, but
    /// was farther away by the slope times (s - r).
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "covered by the safety distance"
    )]
    pub(crate) fn left(
        &self,
        position: &Vector3<f64>,
        rotation: &UnitQuaternion<f64>,
        safety: f32,
    ) -> f32 {
        let before =
            UnitQuaternion::new_unchecked(Vector4::from(self.rotation.map(f64::from)).into());
        let turn = 2.0 * (before.inverse() * rotation).imag().norm();
        let centre = Vector3::from(self.patch.centre.map(f64::from));
        let middle = position + rotation * centre;
        let way = (middle - Vector3::from(self.middle.map(f64::from))).norm();
        let moved = way + turn * f64::from(self.patch.radius);
        if turn > f64::from(SLOPE) {
            return -1.0;
        }
        self.reach - (moved as f32 + safety)
    }
}

/// Numbers in single precision.
#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    reason = "covered by the safety distance"
)]
pub(crate) fn single<const N: usize>(numbers: &[f64; N]) -> [f32; N] {
    numbers.map(|x| x as f32)
}

#[cfg(test)]
mod tests {
    use super::{Pose, single};
    use crate::bodies::scaled_single;
    use crate::candidates::{RelativeSingle, SLOPE, Scratch, search};
    use crate::context::Cutoffs;
    use crate::template::{OuterSphere, Packed};
    use fearless_simd::{Level, dispatch};
    use nalgebra::{Quaternion, UnitQuaternion, Vector3};
    use probability::random_stream::Stream;

    const RADIUS: f64 = 0.45e-3;

    fn vector(stream: &mut Stream) -> Vector3<f64> {
        Vector3::from_fn(|_, _| stream.between(-1.0, 1.0))
    }

    fn turn(stream: &mut Stream) -> UnitQuaternion<f64> {
        let v = vector(stream);
        UnitQuaternion::new_normalize(Quaternion::new(stream.between(-1.0, 1.0), v.x, v.y, v.z))
    }

    /// Sixty spheres at random centres.
    fn body(mut centre: impl FnMut() -> Vector3<f64>) -> Vec<OuterSphere> {
        let spheres = (0..60).map(|_| OuterSphere {
            centre: centre(),
            radius: RADIUS,
            dashpot_mass: 1.0,
        });
        spheres.collect()
    }

    /// A centre in a box of 8 by 4 by 4 mm.
    fn in_box(stream: &mut Stream) -> Vector3<f64> {
        vector(stream).component_mul(&Vector3::new(4e-3, 2e-3, 2e-3))
    }

    /// A centre on a rod of 16 mm along y whose halves are bent back from x by a slope.
    fn on_rod(stream: &mut Stream, slope: f64) -> Vector3<f64> {
        let s = stream.between(-8e-3, 8e-3);
        Vector3::new(-slope * s.abs(), s, 0.0)
    }

    const CUTOFFS: Cutoffs = Cutoffs {
        skin: 0.3e-3,
        reach: 0.0,
        safety: 1e-6,
    };

    /// Two bodies and the pose of b in the frame of a.
    struct Pair {
        a: Vec<OuterSphere>,
        b: Vec<OuterSphere>,
        position: Vector3<f64>,
        rotation: UnitQuaternion<f64>,
        /// Axis of all turns; each is random if this is `None`.
        axis: Option<Vector3<f64>>,
    }

    impl Pair {
        /// Random bodies from deep overlap to far apart.
        fn random(stream: &mut Stream) -> Self {
            let [a, b] = [(); 2].map(|()| body(|| in_box(stream)));
            let rotation = turn(stream);
            let away = vector(stream).normalize();
            Self {
                a,
                b,
                position: away * stream.between(3e-3, 9e-3),
                rotation,
                axis: None,
            }
        }

        /// A straight rod before a bent one, about as steep as the slope of a patch, which a turn in their plane brings near.
        fn rods(stream: &mut Stream) -> Self {
            let rotation = turn(stream);
            let slope = stream.between(0.3, 1.2) * f64::from(SLOPE);
            Self {
                a: body(|| rotation * on_rod(stream, 0.0)),
                b: body(|| on_rod(stream, slope)),
                position: rotation * -Vector3::x() * stream.between(3e-3, 9e-3),
                rotation,
                axis: Some(rotation * Vector3::z()),
            }
        }

        /// The pose of its list, whose pairs of spheres are left in the scratch.
        fn list(&self, scratch: &mut Scratch) -> Pose {
            let rotation = self.rotation.to_rotation_matrix().into_inner();
            let relative = RelativeSingle {
                rotation: scaled_single(&rotation, 1.0),
                position: single(&self.position.data.0[0]),
            };
            let (i, j) = (Packed::new(&self.a), Packed::new(&self.b));
            let (reach, patch) =
                dispatch!(Level::new(), simd => search(simd, &i, &j, &relative, CUTOFFS, scratch));
            Pose::new(&self.position, &self.rotation, &patch, reach)
        }

        /// A later pose after a turn about the middle of the patch, or after a motion about a random point.
        fn moved(
            &self,
            pose: &Pose,
            about_middle: bool,
            stream: &mut Stream,
        ) -> (Vector3<f64>, UnitQuaternion<f64>) {
            let axis = self.axis.unwrap_or_else(|| vector(stream));
            let more = UnitQuaternion::from_scaled_axis(axis * stream.between(-0.4, 0.4));
            let (pivot, shift) = if about_middle {
                (Vector3::from(pose.middle.map(f64::from)), Vector3::zeros())
            } else {
                let pivot = self.position + vector(stream) * 4e-3;
                (pivot, vector(stream) * stream.between(0.0, 0.2e-3))
            };
            let position = pivot + more * (self.position - pivot) + shift;
            (position, more * self.rotation)
        }

        /// The least gap in a pose of the spheres that are not in a list, m.
        fn least_gap(
            &self,
            position: &Vector3<f64>,
            rotation: &UnitQuaternion<f64>,
            list: &[(u16, u16)],
        ) -> f64 {
            let mut least = f64::INFINITY;
            for (k, u) in (0..).zip(&self.a) {
                for (l, v) in (0..).zip(&self.b) {
                    if list.binary_search(&(k, l)).is_err() {
                        let between = position + rotation * v.centre - u.centre;
                        least = least.min(between.norm() - u.radius - v.radius);
                    }
                }
            }
            least
        }
    }

    /// What a list is for: spheres that are not in it have a larger gap than the motion it still covers, however the two bodies
    /// have moved. The rounding of single precision is inside the safety distance of a micrometre. Some trial comes within a
    /// tenth of the skin, or the bound would be of little use.
    #[test]
    fn spheres_outside_the_list_are_farther_than_the_motion_it_covers() {
        let mut stream = Stream::new(3, "pose");
        let mut scratch = Scratch::default();
        let (mut held, mut closest) = (0, f64::INFINITY);
        for trial in 0..600 {
            let pair = if trial % 2 == 1 {
                Pair::rods(&mut stream)
            } else {
                Pair::random(&mut stream)
            };
            let pose = pair.list(&mut scratch);
            for motion in 0..12 {
                let (position, rotation) = pair.moved(&pose, motion % 3 != 0, &mut stream);
                let left = f64::from(pose.left(&position, &rotation, CUTOFFS.safety));
                if left <= 0.0 {
                    continue;
                }
                held += 1;
                let gap = pair.least_gap(&position, &rotation, &scratch.found);
                assert!(gap >= left, "a gap of {gap} m with {left} m left");
                closest = closest.min(gap - left);
            }
        }
        assert!(held > 500, "only {held} lists still hold");
        assert!(closest < 0.03e-3, "the bound is {closest} m off at best");
    }
}
