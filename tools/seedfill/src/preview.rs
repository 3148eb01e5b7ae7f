//! The picture of a filling.

use anyhow::Context as _;
use frame_render::{ObjectView, RenderSphere, render_object, seed_colour};
use sphere_fill::Filling;
use trimesh::TriMesh;

/// Width and height of the picture, pixels.
const PIXELS: u32 = 800;

/// Draws spheres and mesh, as the bytes of a PNG file.
///
/// # Errors
///
/// A body that cannot be drawn.
pub(crate) fn picture(filling: &Filling, mesh: &TriMesh) -> anyhow::Result<Vec<u8>> {
    let spheres: Vec<RenderSphere> = (0..)
        .zip(&filling.spheres)
        .map(|(index, sphere)| RenderSphere {
            centre: sphere.centre.into(),
            radius: sphere.radius,
            colour: seed_colour(index),
        })
        .collect();
    let triangles: Vec<[[f64; 3]; 3]> = (0..mesh.triangles().len())
        .map(|triangle| mesh.corners(triangle).map(Into::into))
        .collect();
    let image = render_object(&spheres, &triangles, &ObjectView::oblique(PIXELS))
        .context("cannot draw the preview")?;
    let mut bytes = std::io::Cursor::new(Vec::new());
    image
        .write_to(&mut bytes, image::ImageFormat::Png)
        .context("cannot draw the preview")?;
    Ok(bytes.into_inner())
}
