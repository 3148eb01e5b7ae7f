//! The picture of a filling.

use anyhow::Context as _;
use frame_render::{ObjectView, RenderSphere, render_object, seed_colour};
use sphere_fill::Filling;
use trimesh::TriMesh;

/// Width and height of the picture, pixels.
const PIXELS: u32 = 800;

/// Points of the mesh that are coloured by their gap.
const DOTS: usize = 30_000;

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
    png_of(&spheres, &triangles)
}

/// Draws the mesh coloured by its gap to the spheres; gives also the gap of full colour, m.
///
/// # Errors
///
/// A body that cannot be drawn.
pub(crate) fn deviation_picture(
    filling: &Filling,
    mesh: &TriMesh,
) -> anyhow::Result<(Vec<u8>, f64)> {
    let gaps = filling.gaps(mesh, DOTS);
    let mut sizes: Vec<f64> = gaps.iter().map(|(_, gap)| gap.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let scale = sizes[DOTS * 95 / 100].max(f64::MIN_POSITIVE);
    // Dots of this radius cover the surface about ten times.
    let radius = (10.0 * mesh.area() / (DOTS as f64 * std::f64::consts::PI)).sqrt();
    let dots: Vec<RenderSphere> = gaps
        .iter()
        .map(|(point, gap)| RenderSphere {
            centre: (*point).into(),
            radius,
            colour: gap_colour(gap / scale),
        })
        .collect();
    Ok((png_of(&dots, &[])?, scale))
}

/// White at 0, blue toward +1 (the spheres fall short), red toward -1 (they stand out).
fn gap_colour(gap: f64) -> [u8; 3] {
    const END: [[f64; 3]; 2] = [[178.0, 24.0, 43.0], [33.0, 102.0, 172.0]];
    let share = gap.abs().min(1.0);
    let end = END[usize::from(gap > 0.0)];
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 0 and 255"
    )]
    end.map(|channel| (245.0 + (channel - 245.0) * share).round() as u8)
}

/// Draws spheres and triangles as the bytes of a PNG file.
fn png_of(spheres: &[RenderSphere], triangles: &[[[f64; 3]; 3]]) -> anyhow::Result<Vec<u8>> {
    let image = render_object(spheres, triangles, &ObjectView::oblique(PIXELS))
        .context("cannot draw the preview")?;
    let mut bytes = std::io::Cursor::new(Vec::new());
    image
        .write_to(&mut bytes, image::ImageFormat::Png)
        .context("cannot draw the preview")?;
    Ok(bytes.into_inner())
}
