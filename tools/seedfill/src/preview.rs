//! The picture of a filling.

use anyhow::Context as _;
use frame_render::{ObjectView, RenderSphere, render_object, seed_colour};
use nalgebra::Vector3;
use sphere_fill::Filling;
use std::f64::consts::PI;
use trimesh::{Changes, TriMesh};

/// Width and height of the picture, pixels.
const PIXELS: u32 = 800;

/// Points of the mesh that are coloured.
const DOTS: usize = 30_000;

/// Colour of a body, and of the lids of its holes.
const BODY: [u8; 3] = [176, 190, 202];
/// See [`BODY`].
const LID: [u8; 3] = [196, 52, 52];

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
    png_of(&spheres, &triangles, &ObjectView::oblique(PIXELS))
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
    let scale = sizes.get(sizes.len() * 95 / 100).copied();
    let scale = scale.unwrap_or(0.0).max(f64::MIN_POSITIVE);
    let coloured = gaps
        .iter()
        .map(|(point, gap)| (*point, gap_colour(gap / scale)));
    let oblique = ObjectView::oblique(PIXELS);
    Ok((png_of(&dots(mesh, coloured), &[], &oblique)?, scale))
}

/// Draws the mesh with the lids of closed holes in red, seen from over the widest one; none without a lid.
///
/// # Errors
///
/// A body that cannot be drawn.
pub(crate) fn lid_picture(mesh: &TriMesh, changes: &Changes) -> anyhow::Result<Option<Vec<u8>>> {
    let (Some(widest), true) = (changes.lids.first(), changes.lid_triangles > 0) else {
        return Ok(None);
    };
    let samples = mesh.surface_samples(DOTS);
    let first = mesh.triangles().len() - changes.lid_triangles;
    let coloured = samples.iter().map(|sample| {
        let colour = if sample.triangle < first { BODY } else { LID };
        (sample.point, colour)
    });
    let on_widest = samples.iter().filter(|sample| {
        sample.triangle >= first && (sample.point - widest.middle).norm() < widest.width
    });
    let mut view = ObjectView::oblique(PIXELS);
    let aside = Vector3::from(view.toward_camera);
    let over: Vector3<f64> = on_widest.map(|sample| sample.normal).sum();
    if let Some(over) = over.try_normalize(0.0) {
        view.toward_camera = (over + 0.5 * aside).into();
    }
    png_of(&dots(mesh, coloured), &[], &view).map(Some)
}

/// Points of a mesh as dots that cover its surface about ten times.
fn dots(
    mesh: &TriMesh,
    points: impl Iterator<Item = (Vector3<f64>, [u8; 3])>,
) -> Vec<RenderSphere> {
    let radius = (10.0 * mesh.area() / (DOTS as f64 * PI)).sqrt();
    let dot = |(point, colour): (Vector3<f64>, [u8; 3])| RenderSphere {
        centre: point.into(),
        radius,
        colour,
    };
    points.map(dot).collect()
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
fn png_of(
    spheres: &[RenderSphere],
    triangles: &[[[f64; 3]; 3]],
    view: &ObjectView,
) -> anyhow::Result<Vec<u8>> {
    let image = render_object(spheres, triangles, view).context("cannot draw the preview")?;
    let mut bytes = Vec::new();
    image
        .write_with_encoder(image::codecs::png::PngEncoder::new(&mut bytes))
        .context("cannot draw the preview")?;
    Ok(bytes)
}
