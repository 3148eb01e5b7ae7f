//! Triangles in a picture: the nearest one before every sample.

use crate::Error;
use nalgebra::Vector3;

/// Which triangles are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Faces {
    /// Those that face the camera: for a closed surface.
    Front,
    /// All: for a wall that is visible from both sides.
    Both,
}

/// Refuses corners that are not finite.
pub(crate) fn check_triangles(triangles: &[[[f64; 3]; 3]]) -> Result<(), Error> {
    for (index, triangle) in triangles.iter().enumerate() {
        if let Some(&value) = triangle
            .as_flattened()
            .iter()
            .find(|value| !value.is_finite())
        {
            return Err(Error::InvalidCoordinate {
                what: "triangle",
                index,
                value,
            });
        }
    }
    Ok(())
}

/// The nearest triangle before every sample.
#[derive(Debug)]
pub(crate) struct Coat {
    /// Width and height, samples.
    samples: u32,
    /// Distance of the nearest triangle toward the camera, samples; row by row.
    near: Vec<f64>,
    /// Place of its normal; without meaning if no surface is near.
    owner: Vec<u32>,
    /// Unit normals of the triangles that face the camera, in camera axes: kept once for each triangle, since
    /// a picture has millions of samples.
    normals: Vec<Vector3<f64>>,
}

/// One sample of the coat.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Layer {
    /// Distance toward the camera, samples.
    pub(crate) near: f64,
    /// Unit normal in camera axes.
    pub(crate) normal: Vector3<f64>,
}

impl Coat {
    /// Draws triangles, whose corners are samples to the right, up and toward the camera from the middle of the picture.
    pub(crate) fn new(
        samples: u32,
        triangles: impl ExactSizeIterator<Item = [Vector3<f64>; 3]>,
        faces: Faces,
    ) -> Self {
        let side = samples as usize;
        let size = if triangles.len() == 0 { 0 } else { side * side };
        let mut coat = Self {
            samples,
            near: vec![f64::NEG_INFINITY; size],
            owner: vec![0; size],
            normals: Vec::new(),
        };
        for [a, b, c] in triangles {
            let away = (b - a).cross(&(c - a)).z < 0.0;
            if away && faces == Faces::Both {
                coat.add([a, c, b]);
            } else {
                coat.add([a, b, c]);
            }
        }
        coat
    }

    /// The visible layer at a sample, if any.
    pub(crate) fn layer(&self, column: u32, row: u32) -> Option<Layer> {
        let place = row as usize * self.samples as usize + column as usize;
        let near = *self.near.get(place)?;
        let normal = *self.normals.get(self.owner[place] as usize)?;
        (near > f64::NEG_INFINITY).then_some(Layer { near, normal })
    }

    /// Draws one triangle by its plane and its three edge functions.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to the picture just before; a mesh has fewer than 2^32 triangles"
    )]
    fn add(&mut self, corners: [Vector3<f64>; 3]) {
        let [a, b, c] = corners;
        let normal = (b - a).cross(&(c - a));
        // Twice the seen area; 0 for a triangle on edge, negative for one that looks away.
        if normal.z <= 0.0 {
            return;
        }
        let own = self.normals.len() as u32;
        self.normals.push(normal.normalize());
        let middle = f64::from(self.samples - 1) / 2.0;
        let last = f64::from(self.samples - 1);
        let range = |values: [f64; 3]| {
            let least = values.into_iter().fold(f64::INFINITY, f64::min);
            let most = values.into_iter().fold(f64::NEG_INFINITY, f64::max);
            ((least + middle).floor().clamp(0.0, last) as u32)
                ..=((most + middle).ceil().clamp(0.0, last) as u32)
        };
        let edge = |from: &Vector3<f64>, to: &Vector3<f64>, x: f64, y: f64| {
            (to.x - from.x) * (y - from.y) - (to.y - from.y) * (x - from.x)
        };
        for row in range([-a.y, -b.y, -c.y]) {
            for column in range([a.x, b.x, c.x]) {
                let x = f64::from(column) - middle;
                let y = middle - f64::from(row);
                let inside = [edge(&a, &b, x, y), edge(&b, &c, x, y), edge(&c, &a, x, y)];
                if inside.iter().any(|&value| value < 0.0) {
                    continue;
                }
                let near = a.z - (normal.x * (x - a.x) + normal.y * (y - a.y)) / normal.z;
                let place = row as usize * self.samples as usize + column as usize;
                if near > self.near[place] {
                    self.near[place] = near;
                    self.owner[place] = own;
                }
            }
        }
    }
}
