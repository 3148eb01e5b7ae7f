//! Our reader of STL against that of the crate `stl_io`.

use std::fs::File;
use std::path::Path;
use trimesh::{LengthUnit, read_stl};

/// Both readers find the same triangles in the meshes that the project comes with. The numbers are
/// read from single precision and scaled to metres, so that only the rounding of the scaling remains;
/// welding may move a corner by a millionth of the size of the seed.
#[test]
fn seeds_have_the_triangles_that_another_reader_finds() {
    for name in ["cotton_ellipsoidal.stl", "cotton_flat.stl"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../fixtures/stl")
            .join(name);
        let ours = read_stl(&path, LengthUnit::Millimetre).unwrap().mesh;
        let theirs = stl_io::read_stl(&mut File::open(&path).unwrap()).unwrap();
        assert_eq!(ours.triangles().len(), theirs.faces.len(), "{name}");
        let size = ours
            .vertices()
            .iter()
            .map(nalgebra::Vector3::amax)
            .fold(0.0, f64::max);
        for (t, face) in theirs.faces.iter().enumerate() {
            for (own, &index) in ours.corners(t).iter().zip(&face.vertices) {
                let other = theirs.vertices[index].0;
                for axis in 0..3 {
                    let difference = (own[axis] - 1e-3 * f64::from(other[axis])).abs();
                    assert!(
                        difference < 1e-6 * size,
                        "{name}, triangle {t}: {difference} m"
                    );
                }
            }
        }
    }
}
