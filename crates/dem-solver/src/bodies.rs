//! State of all bodies, as a structure of arrays.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::contact::Mover;
use crate::load::Load;
use crate::spheres::sphere::Sphere;
use crate::template::Template;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Where a body starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Index of the template.
    pub template: usize,
    /// Position of the centre of mass, m.
    pub position: Vector3<f64>,
    /// Rotation from the principal frame to the world.
    pub orientation: UnitQuaternion<f64>,
    /// Velocity, m/s.
    pub velocity: Vector3<f64>,
    /// Angular velocity in the world frame, rad/s.
    pub spin: Vector3<f64>,
}

impl Placement {
    /// A body at rest.
    pub fn at_rest(
        template: usize,
        position: Vector3<f64>,
        orientation: UnitQuaternion<f64>,
    ) -> Self {
        Self {
            template,
            position,
            orientation,
            velocity: Vector3::zeros(),
            spin: Vector3::zeros(),
        }
    }
}

/// State of all bodies; arrays of one length, one entry a body.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Bodies {
    /// Index of the template of each body.
    pub template: Vec<usize>,
    /// Centres of mass, m.
    pub position: Vec<Vector3<f64>>,
    /// Velocities, m/s.
    pub velocity: Vec<Vector3<f64>>,
    /// Rotations from the principal frames to the world.
    pub orientation: Vec<UnitQuaternion<f64>>,
    /// Angular velocities in the world frame, rad/s.
    pub spin: Vec<Vector3<f64>>,
    /// Angular momenta in the world frame, kg m²/s.
    pub angular_momentum: Vec<Vector3<f64>>,
    /// Rotation matrices, from the principal frames to the world.
    pub(crate) rotation: Vec<Matrix3<f64>>,
    /// The same times the size of a cell of the template (m), row by row, for the overlap test.
    pub(crate) cells_to_metres: Vec<[f32; 9]>,
    /// Contact forces and torques of the last step.
    pub load: Vec<Load>,
    /// Upper bound of the way of the centre of any sphere since the last broad phase, in the frame
    /// that turns with the reference spin, m.
    pub(crate) travel: Vec<f32>,
    /// The same of the centre of mass alone: less where bodies roll, and all that matters for bounding
    /// spheres, m. Not part of a snapshot, which has no lists.
    #[serde(skip)]
    pub(crate) shift: Vec<f32>,
}

impl Bodies {
    /// Bytes of the state of one body.
    pub(crate) const BYTES_OF_EACH: usize = size_of::<usize>()
        + 4 * size_of::<Vector3<f64>>()
        + size_of::<UnitQuaternion<f64>>()
        + size_of::<Matrix3<f64>>()
        + size_of::<[f32; 9]>()
        + size_of::<Load>()
        + 2 * size_of::<f32>();

    /// Number of bodies.
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// Whether all arrays have one length and hold numbers.
    pub(crate) fn is_consistent(&self) -> bool {
        let n = self.template.len();
        let lengths = [
            self.position.len(),
            self.velocity.len(),
            self.orientation.len(),
            self.spin.len(),
            self.angular_momentum.len(),
            self.rotation.len(),
            self.cells_to_metres.len(),
            self.load.len(),
            self.travel.len(),
        ];
        let finite = |vectors: &[Vector3<f64>]| vectors.iter().flatten().all(|x| x.is_finite());
        lengths.iter().all(|&length| length == n)
            && [&self.position, &self.velocity, &self.spin]
                .into_iter()
                .all(|v| finite(v))
    }

    /// Whether there is no body.
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }

    /// Motion of a body.
    #[inline(always)]
    pub(crate) fn mover(&self, k: usize) -> Mover {
        Mover {
            position: self.position[k],
            velocity: self.velocity[k],
            spin: self.spin[k],
        }
    }

    /// Copies all bodies, which are spheres, into a list.
    pub(crate) fn copy_to_spheres(&self, templates: &[Template], spheres: &mut Vec<Sphere>) {
        spheres.clear();
        spheres.extend((0..self.len()).map(|i| {
            let shape = &templates[self.template[i]].spheres[0];
            Sphere::new(shape, &self.mover(i))
        }));
    }

    /// All bodies, with a copy of them as spheres; empty where they are none.
    pub(crate) fn slices<'a>(&'a mut self, spheres: &'a mut [Sphere]) -> BodySlices<'a> {
        BodySlices {
            spheres,
            template: &self.template,
            position: &mut self.position,
            velocity: &mut self.velocity,
            orientation: &mut self.orientation,
            spin: &mut self.spin,
            angular_momentum: &mut self.angular_momentum,
            rotation: &mut self.rotation,
            cells_to_metres: &mut self.cells_to_metres,
            load: &self.load,
            travel: &mut self.travel,
            shift: &mut self.shift,
        }
    }

    /// The bodies in another order: into each place the body of a place of now.
    pub(crate) fn reordered(&self, order: &[usize]) -> Self {
        fn column<T: Copy>(values: &[T], order: &[usize]) -> Vec<T> {
            // What is kept apart from a snapshot is empty there.
            let known = order.iter().filter_map(|&k| values.get(k).copied());
            known.collect()
        }
        Self {
            template: column(&self.template, order),
            position: column(&self.position, order),
            velocity: column(&self.velocity, order),
            orientation: column(&self.orientation, order),
            spin: column(&self.spin, order),
            angular_momentum: column(&self.angular_momentum, order),
            rotation: column(&self.rotation, order),
            cells_to_metres: column(&self.cells_to_metres, order),
            load: column(&self.load, order),
            travel: column(&self.travel, order),
            shift: column(&self.shift, order),
        }
    }

    /// Adds a body.
    pub(crate) fn push(&mut self, placement: &Placement, template: &Template) {
        let rotation = placement.orientation.to_rotation_matrix().into_inner();
        let body_spin = rotation.transpose() * placement.spin;
        self.template.push(placement.template);
        self.position.push(placement.position);
        self.velocity.push(placement.velocity);
        self.orientation.push(placement.orientation);
        self.spin.push(placement.spin);
        self.angular_momentum
            .push(rotation * template.inertia.component_mul(&body_spin));
        self.rotation.push(rotation);
        self.cells_to_metres
            .push(scaled_single(&rotation, template.cell));
        self.load.push(Load::default());
        self.travel.push(0.0);
        self.shift.push(0.0);
    }
}

/// A range of bodies, fields as in [`Bodies`]: what moves them, and what moves.
#[derive(Debug)]
pub(crate) struct BodySlices<'a> {
    /// Copy of the bodies in a world of spheres; empty in another.
    pub(crate) spheres: &'a mut [Sphere],
    pub(crate) template: &'a [usize],
    pub(crate) position: &'a mut [Vector3<f64>],
    pub(crate) velocity: &'a mut [Vector3<f64>],
    pub(crate) orientation: &'a mut [UnitQuaternion<f64>],
    pub(crate) spin: &'a mut [Vector3<f64>],
    pub(crate) angular_momentum: &'a mut [Vector3<f64>],
    pub(crate) rotation: &'a mut [Matrix3<f64>],
    pub(crate) cells_to_metres: &'a mut [[f32; 9]],
    pub(crate) load: &'a [Load],
    pub(crate) travel: &'a mut [f32],
    pub(crate) shift: &'a mut [f32],
}

impl BodySlices<'_> {
    /// Number of bodies.
    pub(crate) fn len(&self) -> usize {
        self.position.len()
    }

    /// Some of the bodies, with these loads.
    pub(crate) fn within<'b>(
        &'b mut self,
        range: Range<usize>,
        load: &'b [Load],
    ) -> BodySlices<'b> {
        BodySlices {
            spheres: &mut self.spheres[range.clone()],
            template: &self.template[range.clone()],
            position: &mut self.position[range.clone()],
            velocity: &mut self.velocity[range.clone()],
            orientation: &mut self.orientation[range.clone()],
            spin: &mut self.spin[range.clone()],
            angular_momentum: &mut self.angular_momentum[range.clone()],
            rotation: &mut self.rotation[range.clone()],
            cells_to_metres: &mut self.cells_to_metres[range.clone()],
            load,
            travel: &mut self.travel[range.clone()],
            shift: &mut self.shift[range],
        }
    }

    /// The bodies before `middle` and those from there on.
    pub(crate) fn split_at(self, middle: usize) -> (Self, Self) {
        let spheres = self.spheres.split_at_mut(middle.min(self.spheres.len()));
        let template = self.template.split_at(middle);
        let position = self.position.split_at_mut(middle);
        let velocity = self.velocity.split_at_mut(middle);
        let orientation = self.orientation.split_at_mut(middle);
        let spin = self.spin.split_at_mut(middle);
        let angular_momentum = self.angular_momentum.split_at_mut(middle);
        let rotation = self.rotation.split_at_mut(middle);
        let cells_to_metres = self.cells_to_metres.split_at_mut(middle);
        let load = self.load.split_at(middle.min(self.load.len()));
        let travel = self.travel.split_at_mut(middle);
        let shift = self.shift.split_at_mut(middle);
        (
            Self {
                spheres: spheres.0,
                template: template.0,
                position: position.0,
                velocity: velocity.0,
                orientation: orientation.0,
                spin: spin.0,
                angular_momentum: angular_momentum.0,
                rotation: rotation.0,
                cells_to_metres: cells_to_metres.0,
                load: load.0,
                travel: travel.0,
                shift: shift.0,
            },
            Self {
                spheres: spheres.1,
                template: template.1,
                position: position.1,
                velocity: velocity.1,
                orientation: orientation.1,
                spin: spin.1,
                angular_momentum: angular_momentum.1,
                rotation: rotation.1,
                cells_to_metres: cells_to_metres.1,
                load: load.1,
                travel: travel.1,
                shift: shift.1,
            },
        )
    }
}

/// A multiple of a matrix in single precision, row by row.
#[inline]
#[expect(
    clippy::cast_possible_truncation,
    reason = "rounding to single precision is meant"
)]
pub(crate) fn scaled_single(m: &Matrix3<f64>, factor: f64) -> [f32; 9] {
    [
        m.m11, m.m12, m.m13, m.m21, m.m22, m.m23, m.m31, m.m32, m.m33,
    ]
    .map(|entry| (entry * factor) as f32)
}
