//! Beds in space: what a record keeps, turned upright, in the rims of its drum.

use super::page;
use crate::pictures::beds::beds;
use crate::test_scene::PEAS;
use crate::test_study::study;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use nalgebra::Vector3;

/// In a scene y is upwards and the camera looks along -z; in the viewer z is upwards and it looks along y. Peas keep their
/// sphere and move with the turn; a turn of half a revolution about y becomes one about z. Two rims stand 20 mm
/// apart outside of the shell of 50 mm. 32-bit floats hold 10 mm to a nanometre.
#[test]
fn a_bed_stands_upright_in_the_rims_of_its_drum() {
    let study = study();
    let beds = beds(&study.input());
    assert!(!beds.is_empty());
    let (_, bed) = &beds[0];
    let close = |a: Vector3<f64>, b: Vector3<f64>| assert!((a - b).norm() < 1e-9, "{a} {b}");
    let [peas @ .., front, back] = &bed.bodies[..] else {
        panic!("rims");
    };
    assert_eq!(peas.len(), PEAS.len());
    for (pea, [_, x, y, z, ..]) in peas.iter().zip(PEAS.map(|pea| pea.map(f64::from))) {
        close(pea.position, Vector3::new(x, -z, y));
    }
    // The x axis of the turned pea points the other way, its y axis (upwards) stays.
    close(peas[1].orientation * Vector3::x(), -Vector3::x());
    close(peas[1].orientation * Vector3::y(), Vector3::z());
    assert!((bed.kinds[peas[0].kind].spheres[0].radius - 3e-3).abs() < 1e-9);
    let ring = &bed.kinds[front.kind].spheres;
    for sphere in ring {
        let centre = front.orientation * Vector3::from(sphere.centre);
        assert!((centre.norm() - sphere.radius - 0.05).abs() < 1e-9);
        assert!(centre.y.abs() < 1e-9, "a ring about the axis of the drum");
    }
    close(
        back.position - front.position,
        Vector3::new(0.0, -0.02, 0.0),
    );
}

/// The page holds the bed for the viewer and a picture of it for everybody else.
#[test]
fn a_bed_of_the_check_stands_in_the_page() {
    let page = page(&study());
    let figure = page.split("The same seeds in space").next().unwrap();
    let figure = figure.rsplit("<figure").next().unwrap();
    assert!(figure.contains("src=\"data:image/png;base64,"));
    let bodies = figure.split("data-bodies=\"").nth(1).unwrap();
    let bytes = STANDARD.decode(bodies.split('"').next().unwrap()).unwrap();
    // Peas and two rims, of eight floats each.
    assert_eq!(bytes.len(), (PEAS.len() + 2) * 32);
}
