//! OBJ and PLY files, whole and broken.

use trimesh::{CheckedMesh, Error, LengthUnit, parse_mesh};

const MM: LengthUnit = LengthUnit::Millimetre;

/// Corners of a box of 9 x 5 x 4 and its six faces, counter-clockwise seen from outside.
const CORNERS: [[f32; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [9.0, 0.0, 0.0],
    [9.0, 5.0, 0.0],
    [0.0, 5.0, 0.0],
    [0.0, 0.0, 4.0],
    [9.0, 0.0, 4.0],
    [9.0, 5.0, 4.0],
    [0.0, 5.0, 4.0],
];
const FACES: [[u8; 4]; 6] = [
    [0, 3, 2, 1],
    [4, 5, 6, 7],
    [0, 1, 5, 4],
    [1, 2, 6, 5],
    [2, 3, 7, 6],
    [3, 0, 4, 7],
];

fn obj(face: impl Fn([u8; 4]) -> String) -> String {
    let vertices = CORNERS.map(|[x, y, z]| format!("v {x} {y} {z}\n")).concat();
    let faces = FACES.map(|f| format!("f {}\n", face(f))).concat();
    format!("# a box\no box\n{vertices}vn 0 0 1\ns off\n{faces}")
}

fn plain_obj() -> String {
    obj(|f| f.map(|i| (i + 1).to_string()).join(" "))
}

fn header(format: &str, faces: usize) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment made by a scanner\nelement vertex 8\n\
         property float x\nproperty float y\nproperty float z\nproperty uchar red\n\
         element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    )
}

fn ascii_ply() -> String {
    let vertices = CORNERS.map(|[x, y, z]| format!("{x} {y} {z} 255\n"));
    let faces = FACES.map(|[a, b, c, d]| format!("4 {a} {b} {c} {d}\n"));
    header("ascii", 6) + &vertices.concat() + &faces.concat()
}

fn binary_ply(little: bool) -> Vec<u8> {
    let name = if little {
        "binary_little_endian"
    } else {
        "binary_big_endian"
    };
    let ordered = |bytes: [u8; 4]| {
        let mut bytes = bytes;
        if !little {
            bytes.reverse();
        }
        bytes
    };
    let mut found = header(name, 6).into_bytes();
    for corner in CORNERS {
        found.extend(corner.map(|v| ordered(v.to_le_bytes())).concat());
        found.push(200);
    }
    for face in FACES {
        found.push(4);
        found.extend(face.map(|i| ordered(i32::from(i).to_le_bytes())).concat());
    }
    found
}

fn read(bytes: impl Into<Vec<u8>>, name: &str) -> Result<CheckedMesh, Error> {
    parse_mesh(bytes.into(), MM, name)
}

/// Every file holds the same box of 180 mm³; its numbers are exact in single precision.
#[test]
fn every_form_of_the_box_has_its_volume() {
    let relative = obj(|f| f.map(|i| format!("-{}", 8 - i)).join(" "));
    let with_normals = obj(|f| f.map(|i| format!("{}//1", i + 1)).join(" "));
    let long = obj(|[a, b, c, d]| format!("{} {} \\\n {} {}", a + 1, b + 1, c + 1, d + 1));
    let cases: [(&str, Vec<u8>); 9] = [
        ("box.obj", plain_obj().into()),
        ("box.OBJ", plain_obj().replace('\n', "\r\n").into()),
        ("no_extension", plain_obj().into()),
        ("relative.obj", relative.into()),
        ("normals.obj", with_normals.into()),
        ("long.obj", long.into()),
        ("box.ply", ascii_ply().into()),
        ("little.ply", binary_ply(true)),
        ("big.ply", binary_ply(false)),
    ];
    for (name, bytes) in cases {
        let found = read(bytes, name).unwrap_or_else(|error| panic!("{error}"));
        assert!(found.report.watertight, "{name} is not closed");
        assert_eq!(
            (found.report.triangles, found.report.vertices),
            (12, 8),
            "{name}"
        );
        let volume = found.mesh.moments().volume;
        assert!((volume / 180e-9 - 1.0).abs() < 1e-12, "{name}: {volume}");
        assert_eq!(found.report.warnings, [], "{name}");
    }
}

/// Each is refused with its name and its place; a count of 4e9 rows takes no memory.
#[test]
fn damaged_files_are_refused_with_their_place() {
    let ply = ascii_ply();
    let little = binary_ply(true);
    let huge = String::from_utf8_lossy(&little[..header("binary_little_endian", 6).len()])
        .replace("vertex 8", "vertex 4000000000");
    let cases: [(&str, Vec<u8>, &str); 12] = [
        (
            "a.obj",
            plain_obj().replace("f 1 ", "f 99 ").into(),
            "line 13",
        ),
        ("a.obj", plain_obj().replace("f 1 ", "f 0 ").into(), "`0`"),
        (
            "a.obj",
            plain_obj().replace("v 9 ", "v nan ").into(),
            "`nan`",
        ),
        (
            "a.obj",
            plain_obj().replace("v 9 0 0", "v 9 0").into(),
            "line 4",
        ),
        ("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n".into(), "three or more"),
        ("a.obj", "v 0 0 0\n".into(), "1 points without triangles"),
        (
            "a.ply",
            ply.replace("4 0 3 2 1", "4 0 3 2 8").into(),
            "line 20",
        ),
        ("a.ply", ply.replace("float y", "floot y").into(), "`floot`"),
        (
            "a.ply",
            ply.replace("property float z\n", "").into(),
            "x, y, z",
        ),
        (
            "a.ply",
            ply.replace("end_header", "end").into(),
            "end_header",
        ),
        ("a.ply", little[..little.len() - 3].to_vec(), "byte "),
        ("a.ply", huge.into(), "byte 0 of 0"),
    ];
    for (name, bytes, part) in cases {
        let message = read(bytes, name).expect_err(part).to_string();
        assert!(
            message.contains(name) && message.contains(part),
            "{part}: {message}"
        );
    }
}

/// A face that a scan lost is put back when it is small, and said; a large one is not.
#[test]
fn small_holes_are_closed_and_large_ones_left() {
    let ball = trimesh::shapes::ellipsoid([4e-3, 3e-3, 2e-3], 60).unwrap();
    let soup = |keep: &dyn Fn(usize) -> bool| -> Vec<_> {
        let kept = (0..ball.triangles().len()).filter(|&t| keep(t));
        kept.map(|t| ball.corners(t)).collect()
    };
    let build = |soup: &[_]| {
        trimesh::TriMesh::from_triangles(soup, LengthUnit::Metre, "ball").expect("a mesh")
    };
    // Two holes: one triangle, and the ring of triangles about a vertex.
    let vertex = ball.triangles()[9000][0];
    let small = build(&soup(&|t| {
        t != 700 && !ball.triangles()[t].contains(&vertex)
    }));
    assert_eq!(small.report.holes_closed, 2);
    assert!(small.report.watertight);
    let volume = small.report.volume.unwrap() / ball.moments().volume;
    assert!((volume - 1.0).abs() < 1e-5, "{volume}");
    let large = build(&soup(&|t| t > 400));
    assert_eq!(
        (large.report.holes_closed, large.report.watertight),
        (0, false)
    );
}

/// The body of a unit ball below the height z has the volume π (2/3 + z − z³/3); its facets and the
/// saw teeth of the rim, which the lid joins, take 1 %.
#[test]
fn an_open_bottom_is_closed_flat_only_when_it_is_asked_for() {
    let ball = trimesh::shapes::ellipsoid([1.0; 3], 60).unwrap();
    let kept = (0..ball.triangles().len()).map(|t| ball.corners(t));
    let height = |t: &[nalgebra::Vector3<f64>; 3]| (t[0] + t[1] + t[2]).z / 3.0;
    let mut obj = String::new();
    for corners in kept.filter(|t| height(t) < 0.6) {
        for c in corners {
            obj.extend([format!("v {} {} {}\n", c.x, c.y, c.z)]);
        }
        obj += "f -3 -2 -1\n";
    }
    let folder = std::env::temp_dir().join(format!("open-ball-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("open.obj");
    std::fs::write(&file, obj).unwrap();
    let closed = |width_mm: f64| {
        let repair = trimesh::Repair {
            close_holes: Some(width_mm * 1e-3),
            ..trimesh::Repair::default()
        };
        trimesh::read_mesh_with(&file, MM, &repair).unwrap()
    };
    let (narrow, wide) = (closed(1.0), closed(2.5));
    std::fs::remove_dir_all(&folder).unwrap();
    let message = narrow.mesh.require_closed().unwrap_err().to_string();
    assert!(message.contains("holes: 1, the widest 2.2"), "{message}");
    wide.mesh.require_closed().unwrap();
    let exact = std::f64::consts::PI * (2.0 / 3.0 + 0.6 - 0.6_f64.powi(3) / 3.0) * 1e-9;
    let volume = wide.report.volume.unwrap() / exact;
    assert!((volume - 1.0).abs() < 0.01, "{volume}");
    // The lid is the disc of radius 0.8.
    let lid = wide.report.changes.lids[0].area / (std::f64::consts::PI * 0.64e-6);
    assert!((lid - 1.0).abs() < 0.05, "{lid}");
}

/// A flap and a closed crumb on edges of a ball are cut away and told; what is larger than the
/// share is not, and nothing of the ball itself is lost.
#[test]
fn crumbs_on_shared_edges_are_cut_away_below_their_share() {
    let ball = trimesh::shapes::ellipsoid([4e-3, 3e-3, 2e-3], 60).unwrap();
    let soup: Vec<_> = (0..ball.triangles().len())
        .map(|t| ball.corners(t))
        .collect();
    let with = |height: f64| {
        let [a, b, _] = ball.corners(5000);
        let [c, d, _] = ball.corners(9000);
        let tip = |p: nalgebra::Vector3<f64>| p * (1.0 + height);
        let crumb = [
            [c, d, tip(c)],
            [d, tip(d), tip(c)],
            [c, tip(c), tip(d)],
            [c, tip(d), d],
        ];
        let soup = [&soup[..], &[[a, b, tip(a)]], &crumb].concat();
        trimesh::TriMesh::from_triangles(&soup, LengthUnit::Metre, "ball").unwrap()
    };
    let small = with(0.05);
    small.mesh.require_closed().unwrap();
    let changes = &small.report.changes;
    assert_eq!((changes.pieces_cut, changes.triangles_cut), (2, 5));
    assert!(changes.cut_share > 0.0 && changes.cut_share < 1e-3);
    assert!((small.report.volume.unwrap() / ball.moments().volume - 1.0).abs() < 1e-12);
    assert!(with(3.0).mesh.require_closed().is_err());
}

/// Points of a scanner as PLY, OBJ and plain numbers: reported as what they are, with the remedy.
#[test]
fn point_clouds_are_told_as_such() {
    let points = CORNERS.map(|[x, y, z]| format!("{x} {y} {z}\n")).concat();
    let ply = header("ascii", 0) + &points.replace('\n', " 255\n");
    let obj = CORNERS.map(|[x, y, z]| format!("v {x} {y} {z}\n")).concat();
    let commas = points.replace(' ', ",");
    for (text, count) in [
        (ply, "8 points"),
        (obj, "8 points"),
        (points, "lines of numbers"),
        (commas, "lines of numbers"),
    ] {
        let error = parse_mesh(text.into_bytes(), MM, "cloud").unwrap_err();
        let told = error.to_string();
        assert!(matches!(error, Error::PointCloud { .. }), "{told}");
        assert!(told.contains(count) && told.contains("Poisson"), "{told}");
    }
}
