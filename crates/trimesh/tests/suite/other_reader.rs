//! Our reader of STL against that of the crate `stl_io`.

use dev_support::fixture_files::fixture;
use std::fs::File;
use std::io::Cursor;
use trimesh::{LengthUnit, parse_mesh, read_mesh};

/// Both readers find the same triangles in the meshes that the project comes with. The numbers are
/// read from single precision and scaled to metres, so that only the rounding of the scaling remains;
/// welding may move a corner by a millionth of the size of the seed.
#[test]
fn seeds_have_the_triangles_that_another_reader_finds() {
    for name in ["cotton_ellipsoidal.stl", "cotton_flat.stl"] {
        let path = fixture("stl").join(name);
        let ours = read_mesh(&path, LengthUnit::Millimetre).unwrap().mesh;
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

/// The four faces of a tetrahedron.
const FACES: [[[f32; 3]; 3]; 4] = [
    [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]],
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
    [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]],
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
];

/// Faces as ASCII.
fn facets(faces: &[[[f32; 3]; 3]]) -> String {
    let vertex = |[x, y, z]: &[f32; 3]| format!("vertex {x} {y} {z}\n");
    let facet = |corners: &[[f32; 3]; 3]| {
        let corners: String = corners.iter().map(vertex).collect();
        format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n")
    };
    faces.iter().map(facet).collect()
}

/// The faces as binary STL whose head tells a number of them.
fn binary(told: u32) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(told.to_le_bytes());
    for face in FACES {
        bytes.extend([0; 12]);
        bytes.extend(face.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0, 0]);
    }
    bytes
}

/// Why STL has a reader of its own here: files as programs write them, of which the other reader loses a part without a word
/// or reads nothing. All hold one tetrahedron.
#[test]
fn whole_files_are_read_of_which_another_reader_loses_a_part_or_all() {
    let all = facets(&FACES);
    let two = format!(
        "solid a\n{}endsolid a\nsolid b\n{}endsolid b\n",
        facets(&FACES[..2]),
        facets(&FACES[2..])
    );
    let cases = [
        ("two solids", two.into_bytes(), Some(2)),
        ("a count that is too low", binary(2), Some(2)),
        ("no end", format!("solid a\n{all}").into_bytes(), None),
        (
            "no name",
            format!("solid\n{all}endsolid\n").into_bytes(),
            None,
        ),
        (
            "capitals",
            format!("SOLID a\n{}ENDSOLID a\n", all.to_uppercase()).into_bytes(),
            None,
        ),
        (
            "carriage returns alone",
            format!("solid a\n{all}endsolid a\n")
                .replace('\n', "\r")
                .into_bytes(),
            None,
        ),
    ];
    for (what, bytes, others) in cases {
        let theirs = stl_io::read_stl(&mut Cursor::new(&bytes)).ok();
        assert_eq!(theirs.map(|mesh| mesh.faces.len()), others, "{what}");
        let ours = parse_mesh(bytes, LengthUnit::Millimetre, what).unwrap();
        assert_eq!(ours.mesh.triangles().len(), FACES.len(), "{what}");
    }
}
