//! Spheres at the peaks of the distance to the surface.

use crate::{Body, Error, FillSettings, Place};
use geometry::clump::Sphere;
use nalgebra::Vector3;

/// Nodes along the longest extent of the body.
const NODES: f64 = 64.0;

/// Part of its radius by which a placed sphere lets others in.
const OVERLAP: f64 = 0.5;

/// Most spheres, when neither a count nor a limit is given.
const MOST: usize = 400;

/// Spheres one after another at the deepest point that is left.
///
/// # Method
///
/// On a cubic grid of 64 nodes along the body, the depth of a node is its distance to the surface
/// or to the spheres placed before, these shrunk to half their radius, whichever is less. The
/// deepest node becomes the centre of the next sphere and its depth the radius, until the depth
/// falls below the smallest radius or the count is reached.
///
/// # Source
///
/// The method "Euclidean" of `[Angelidakis2021]`; its overlap factor is 0.5 here.
#[derive(Debug, Clone, Copy)]
pub struct DistanceTransform;

impl Place for DistanceTransform {
    fn place(&self, body: &Body<'_>, settings: &FillSettings) -> Result<Vec<Sphere>, Error> {
        let mut nodes = inner_nodes(body);
        // The largest inscribed sphere may lie between the nodes.
        nodes.push((body.inscribed_centre, body.inscribed_radius));
        let most = settings.count_or(MOST);
        let mut spheres: Vec<Sphere> = Vec::new();
        while spheres.len() < most {
            let deepest = nodes.iter().max_by(|a, b| a.1.total_cmp(&b.1));
            let Some(&(centre, radius)) = deepest.filter(|(_, depth)| *depth >= settings.radius)
            else {
                break;
            };
            for (node, depth) in &mut nodes {
                let room = (*node - centre).norm() - (1.0 - OVERLAP) * radius;
                *depth = depth.min(room);
            }
            spheres.push(Sphere { centre, radius });
        }
        match settings.count {
            Some(asked) if spheres.len() < asked => Err(Error::CountNotReached {
                mesh: body.mesh.source().to_owned(),
                asked,
                reached: spheres.len(),
                radius_mm: settings.radius * 1e3,
                method: settings.method,
            }),
            _ => Ok(spheres),
        }
    }
}

/// Nodes inside the body, with their depth.
fn inner_nodes(body: &Body<'_>) -> Vec<(Vector3<f64>, f64)> {
    let bounds = body.mesh.bounding_box();
    let step = bounds.size().amax() / NODES;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "at most the number of nodes along the longest extent"
    )]
    let size = [0, 1, 2].map(|k| (bounds.size()[k] / step).ceil() as usize);
    let mut nodes = Vec::new();
    let mut guess = 0;
    for index in 0..size.iter().product() {
        let cell = [
            index / (size[1] * size[2]),
            index / size[2] % size[1],
            index % size[2],
        ];
        let node = bounds.low + Vector3::from_fn(|k, _| (cell[k] as f64 + 0.5) * step);
        let found = body.distance.nearest_from(&node, guess);
        guess = found.triangle;
        if found.distance < 0.0 {
            nodes.push((node, -found.distance));
        }
    }
    nodes
}
