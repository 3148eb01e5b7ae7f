//! The report of a filling as one HTML page.

use crate::preview::{deviation_picture, lid_picture, picture};
use crate::summary::{Measured, Summary};
use command_line::significant;
use report::{Fact, Report, SphereViewer, ViewerBody, ViewerKind, ViewerSphere};
use trimesh::TriMesh;

/// Colour of the spheres in the viewer.
const COLOUR: [u8; 3] = [168, 142, 112];

/// Makes the page: figures, pictures, and spheres to be turned.
///
/// # Errors
///
/// A body that cannot be drawn.
pub(crate) fn page(
    summary: &Summary,
    measured: &Measured<'_>,
    mesh: &TriMesh,
) -> anyhow::Result<String> {
    let filling = measured.filling;
    let fact = |(name, value): &(&str, String)| Fact::new(*name, value.clone());
    let facts = |lines: &[(&str, String)]| lines.iter().map(fact).collect::<Vec<_>>();
    let mut report = Report::new(format!("Filling of {}", mesh.source()));
    for (title, lines) in [
        ("Shape of the mesh", summary.shape_lines()),
        ("Fit", summary.fit_lines()),
        ("Moments and axes", summary.moment_lines()),
        ("Pieces and contacts", summary.connection_lines()),
        ("Mass and cost", summary.cost_lines()),
    ] {
        report.section(title).facts(&facts(&lines));
    }
    let of_mesh = summary.mesh_warnings().iter().map(ToString::to_string);
    for (title, warnings) in [
        ("What to know of the spheres", summary.warnings().to_vec()),
        ("What was found in the mesh", of_mesh.collect()),
    ] {
        if !warnings.is_empty() {
            let warnings: Vec<&str> = warnings.iter().map(String::as_str).collect();
            report.section(title).list(&warnings);
        }
    }
    let drawn = pictures(&mut report, measured, mesh)?;
    let spheres = filling.spheres.iter().map(|sphere| ViewerSphere {
        centre: sphere.centre.into(),
        radius: sphere.radius,
    });
    let kind = ViewerKind {
        spheres: spheres.collect(),
        colour: COLOUR,
    };
    let viewer = SphereViewer {
        kinds: &[kind],
        bodies: &[ViewerBody::at_origin(0)],
        picture: &drawn,
        description: "The spheres of the filling",
    };
    report.viewer(&viewer, "The spheres; drag to turn.")?;
    for line in summary.provenance() {
        report.provenance(&line);
    }
    Ok(report.html())
}

/// Adds the pictures; returns that of mesh and spheres.
fn pictures(
    report: &mut Report,
    measured: &Measured<'_>,
    mesh: &TriMesh,
) -> anyhow::Result<Vec<u8>> {
    let filling = measured.filling;
    let drawn = picture(filling, mesh)?;
    let (coloured, scale) = deviation_picture(filling, mesh)?;
    report.section("Pictures");
    report.picture(
        &drawn,
        "The mesh, half transparent, over the spheres",
        "The mesh, half transparent, over the spheres.",
    )?;
    let caption = format!(
        "Gap between mesh and spheres: blue where the spheres fall short, red where they stand \
         out, full colour at {} mm (the gap that 95 % of the surface keeps).",
        significant(scale * 1e3, 3)
    );
    report.picture(
        &coloured,
        "The mesh coloured by its gap to the spheres",
        &caption,
    )?;
    if let Some(lids) = lid_picture(mesh, &measured.mesh.changes)? {
        report.picture(
            &lids,
            "The mesh with the lids of its holes in red",
            "The mesh with what closes its holes in red, seen from over the widest one.",
        )?;
    }
    Ok(drawn)
}
