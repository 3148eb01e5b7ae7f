//! Reading good, odd and broken files.

use nalgebra::Vector3;
use std::fmt::Write as _;
use trimesh::{Error, LengthUnit, TriMesh, Warning, parse_mesh, shapes};

const MM: LengthUnit = LengthUnit::Millimetre;

/// Triangles of a box of 9 x 5 x 4, without unit.
fn soup() -> Vec<[Vector3<f64>; 3]> {
    soup_of(&shapes::cuboid([9.0, 5.0, 4.0]).expect("positive sizes"))
}

fn soup_of(mesh: &TriMesh) -> Vec<[Vector3<f64>; 3]> {
    (0..mesh.triangles().len())
        .map(|t| mesh.corners(t))
        .collect()
}

fn binary(soup: &[[Vector3<f64>; 3]], header: &[u8]) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(80, b' ');
    bytes.extend(
        u32::try_from(soup.len())
            .expect("few triangles")
            .to_le_bytes(),
    );
    for corners in soup {
        bytes.extend([0_u8; 12]);
        for value in corners.iter().flat_map(|c| [c.x, c.y, c.z]) {
            #[expect(
                clippy::cast_possible_truncation,
                reason = "the format is single precision"
            )]
            bytes.extend((value as f32).to_le_bytes());
        }
        bytes.extend([0_u8; 2]);
    }
    bytes
}

fn ascii(soup: &[[Vector3<f64>; 3]], name: &str, normal: &str) -> String {
    let mut text = format!("solid {name}\n");
    for corners in soup {
        text.extend(["facet normal ", normal, "\n outer loop\n"]);
        for c in corners {
            writeln!(text, "  vertex {} {} {:e}", c.x, c.y, c.z).expect("a string takes all text");
        }
        text += " endloop\nendfacet\n";
    }
    text + "endsolid\n"
}

fn turn_over(soup: &mut [[Vector3<f64>; 3]]) {
    for corners in soup {
        corners.swap(0, 1);
    }
}

#[track_caller]
fn volume_of(bytes: Vec<u8>) -> f64 {
    let read = parse_mesh(bytes, MM, "box.stl").expect("a whole file");
    assert!(read.report.watertight, "not closed");
    assert_eq!((read.report.triangles, read.report.vertices), (12, 8));
    read.mesh.moments().volume
}

#[track_caller]
fn message_of(bytes: Vec<u8>) -> String {
    parse_mesh(bytes, MM, "box.stl")
        .expect_err("a damaged file")
        .to_string()
}

/// All these are in the wild; each must give the box of 180 mm³ (its numbers are exact in
/// single precision, so only rounding is left).
#[test]
fn odd_but_whole_files_are_read() {
    let soup = soup();
    let plain = ascii(&soup, "seed", "0 0 1");
    let mut marked = b"\xEF\xBB\xBF".to_vec();
    marked.extend(plain.bytes());
    let mut latin = plain.clone().into_bytes();
    latin[6] = 0xE4;
    let two = ascii(&soup[..5], "one", "0 0 1") + &ascii(&soup[5..], "two", "0 0 1");
    let cases: Vec<(&str, Vec<u8>)> = vec![
        ("binary", binary(&soup, b"made by a scanner")),
        (
            "binary with the header of a text file",
            binary(&soup, b"solid x\nfacet"),
        ),
        ("binary with a zero header", binary(&soup, &[0; 80])),
        ("text", plain.clone().into_bytes()),
        ("carriage returns", plain.replace('\n', "\r\n").into_bytes()),
        ("old line ends", plain.replace('\n', "\r").into_bytes()),
        ("upper case", plain.to_uppercase().into_bytes()),
        (
            "no name",
            ascii(&soup, "", "0 0 1")
                .replace("solid ", "solid")
                .into_bytes(),
        ),
        ("leading blanks", format!("\n  {plain}").into_bytes()),
        ("byte-order mark", marked),
        ("name that is not UTF-8", latin),
        (
            "nan normals",
            ascii(&soup, "seed", "nan -nan NaN").into_bytes(),
        ),
        ("two solids", two.into_bytes()),
        (
            "one long line",
            plain
                .replacen("seed\n", "seed\r\n", 1)
                .replace("\n ", " ")
                .into_bytes(),
        ),
    ];
    for (case, bytes) in cases {
        let volume = volume_of(bytes);
        assert!((volume / 180e-9 - 1.0).abs() < 1e-12, "{case}: {volume}");
    }
}

/// A header that counts too few, bytes after the end, and a text without its last line: the whole
/// box is read, and the report says what was odd.
#[test]
fn wrong_counts_and_trailing_bytes_are_told() {
    let soup = soup();
    let counted = |n: u32| {
        let mut bytes = binary(&soup, b"");
        bytes[80..84].copy_from_slice(&n.to_le_bytes());
        bytes
    };
    let followed = |rest: &[u8]| [&binary(&soup, b"solid facet")[..], rest].concat();
    let text = ascii(&soup, "seed", "0 0 1").replace("endsolid\n", "");
    let found = 12;
    let cases = [
        (counted(5), Warning::CountCorrected { declared: 5, found }),
        (counted(0), Warning::CountCorrected { declared: 0, found }),
        (followed(b"made by"), Warning::TrailingBytes(7)),
        (followed(&[0xFF; 100]), Warning::TrailingBytes(100)),
        (text.into_bytes(), Warning::NoEnd),
    ];
    for (bytes, warning) in cases {
        let report = parse_mesh(bytes.clone(), MM, "box.stl").unwrap().report;
        assert_eq!(report.warnings, [warning]);
        assert!((volume_of(bytes) / 180e-9 - 1.0).abs() < 1e-12);
    }
}

#[test]
fn units_scale_the_mesh() {
    for (unit, metre) in [("mm", 1e-3), ("cm", 1e-2), ("m", 1.0), ("um", 1e-6)] {
        let unit: LengthUnit = unit.parse().unwrap();
        let read = parse_mesh(binary(&soup(), b""), unit, "box.stl").unwrap();
        let length = read.report.bounding_box.size().x;
        assert!(
            (length / (9.0 * metre) - 1.0).abs() < 1e-12,
            "{unit}: {length}"
        );
    }
    let message = "inch".parse::<LengthUnit>().unwrap_err().to_string();
    assert!(
        message.contains("`inch`") && message.contains("mm, cm, m or um"),
        "{message}"
    );
}

#[test]
fn damaged_files_are_refused_with_file_and_place() {
    let soup = soup();
    let good = binary(&soup, b"");
    let mut huge = good.clone();
    huge[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    let text = ascii(&soup, "seed", "0 0 1");
    let half = text[..text.rfind("endloop").unwrap()].to_owned();
    let cases: Vec<(&str, Vec<u8>, &str)> = vec![
        ("empty", vec![], "0 bytes"),
        (
            "cut off",
            good[..good.len() - 30].to_vec(),
            "declares 12 triangles",
        ),
        ("huge count", huge, "declares 4294967295 triangles"),
        ("count 0", binary(&[], b""), "no triangle"),
        ("short", b"solid".to_vec(), "no STL, OBJ or PLY"),
        ("prose", vec![b'x'; 5000], "it begins with `xxxx"),
        // Letters beyond ASCII where a binary file has its count, and an escape character.
        (
            "foreign text",
            [&[b'a'; 79][..], b"\x1b\xa1\xcb\xab\\", &[b'b'; 300]].concat(),
            "is a text, but no STL",
        ),
        (
            "a text of two-byte characters",
            "\u{feff}solid seed, written wide "
                .repeat(9)
                .encode_utf16()
                .flat_map(u16::to_le_bytes)
                .collect(),
            "UTF-16",
        ),
        ("a few bytes", vec![0x01; 20], "takes 84 bytes, but has 20"),
        ("random", vec![0x01; 700], "declares"),
        ("text cut off", half.into_bytes(), "end of file"),
        (
            "text with a hole",
            text.replacen("vertex", "vortex", 1).into_bytes(),
            "line 4",
        ),
        (
            "text with a nan corner",
            text.replacen("vertex 4.5", "vertex nan", 1).into_bytes(),
            "finite",
        ),
        (
            "overflowing number",
            text.replacen("vertex 4.5", "vertex 1e999", 1).into_bytes(),
            "1e999",
        ),
        (
            "no facets",
            b"solid a\nendsolid a\n".to_vec(),
            "no triangle",
        ),
    ];
    for (case, bytes, part) in cases {
        let message = message_of(bytes);
        assert!(message.contains("box.stl"), "{case}: {message}");
        assert!(message.contains(part), "{case}: {message}");
    }
}

#[test]
fn not_finite_and_flat_meshes_are_refused() {
    for bad in [f32::NAN, f32::INFINITY] {
        let mut bytes = binary(&soup(), b"");
        bytes[84 + 50 * 3 + 12..][..4].copy_from_slice(&bad.to_le_bytes());
        let message = message_of(bytes);
        assert!(message.contains("triangle 3, corner 0"), "{message}");
    }
    let tilted = |p: Vector3<f64>| Vector3::new(p.x, p.y, p.x + 0.5 * p.y);
    let flat: Vec<_> = soup().iter().map(|t| t.map(tilted)).collect();
    let message = message_of(ascii(&flat, "flat", "0 0 0").into_bytes());
    assert!(message.contains("is flat"), "{message}");
}

#[test]
fn a_missing_file_is_named() {
    let error = trimesh::read_mesh("no/such/seed.stl".as_ref(), MM).unwrap_err();
    assert!(matches!(error, Error::Read { .. }));
    assert!(error.to_string().contains("no/such/seed.stl"));
}

#[test]
fn an_open_mesh_is_read_with_a_warning_and_refused_as_a_body() {
    let mut soup = soup();
    soup.remove(4);
    let read = TriMesh::from_triangles(&soup, MM, "open.stl").unwrap();
    assert!(!read.report.watertight && read.report.volume.is_none());
    assert!(read.report.warnings.contains(&Warning::OpenEdges(3)));
    let message = read.mesh.require_closed().unwrap_err().to_string();
    assert!(
        message.contains("open.stl is not closed: 3 edges"),
        "{message}"
    );
    assert!(message.contains(" mm"), "no place: {message}");
}

#[test]
fn turned_repeated_and_degenerate_triangles_are_repaired_and_counted() {
    let mut soup = soup();
    for t in [1, 6, 7] {
        soup[t].swap(0, 1);
    }
    soup.push(soup[0]);
    soup.push([soup[0][0], soup[0][0], soup[0][1]]);
    let read = TriMesh::from_triangles(&soup, MM, "faulty").unwrap();
    let report = &read.report;
    assert_eq!(
        (
            report.triangles_turned,
            report.duplicates_dropped,
            report.degenerate_dropped
        ),
        (3, 1, 1)
    );
    assert!(report.watertight);
    assert!((report.volume.unwrap() / 180e-9 - 1.0).abs() < 1e-12);
}

#[test]
fn a_mesh_that_is_inside_out_is_turned() {
    let mut soup = soup();
    turn_over(&mut soup);
    let read = TriMesh::from_triangles(&soup, MM, "inside out").unwrap();
    assert_eq!(read.report.triangles_turned, 12);
    assert!(read.report.volume.unwrap() > 0.0);
}

fn moved(soup: &[[Vector3<f64>; 3]], scale: f64, shift: Vector3<f64>) -> Vec<[Vector3<f64>; 3]> {
    soup.iter().map(|t| t.map(|c| c * scale + shift)).collect()
}

/// A shell inside another bounds a cavity, however it was wound: 180 − 180/8 mm³ are left.
#[test]
fn an_inner_shell_is_a_cavity() {
    let outer = soup();
    for swapped in [false, true] {
        let mut inner = moved(&outer, 0.5, Vector3::new(0.3, 0.2, -0.1));
        if swapped {
            turn_over(&mut inner);
        }
        let all = [outer.clone(), inner].concat();
        let read = TriMesh::from_triangles(&all, MM, "hollow").unwrap();
        assert_eq!(
            (read.mesh.topology().shells, read.mesh.topology().bodies),
            (2, 1)
        );
        assert!((read.report.volume.unwrap() / 157.5e-9 - 1.0).abs() < 1e-12);
        assert!(read.mesh.require_closed().is_ok());
    }
}

#[test]
fn two_bodies_apart_or_cutting_each_other_are_refused() {
    for shift in [20.0, 6.0] {
        let second = moved(&soup(), 1.0, Vector3::new(shift, 0.7, 0.3));
        let all = [soup(), second].concat();
        let read = TriMesh::from_triangles(&all, MM, "two").unwrap();
        let message = read.mesh.require_closed().unwrap_err().to_string();
        assert!(
            message.contains("2 separate or intersecting bodies")
                && message.contains("enclose 180.0, 180.0 mm3"),
            "{message}"
        );
    }
}

/// Forty-eight cavities, none of them a body: 180 mm³ less 48 times 180 / 20³.
#[test]
fn a_porous_body_is_one_body() {
    let pores = (0..48).map(|k| {
        let place = [k % 4, k / 4 % 4, k / 16].map(f64::from);
        let shift = Vector3::new(2.0 * place[0] - 3.0, place[1] - 1.5, 1.2 * place[2] - 1.2);
        moved(&soup(), 0.05, shift)
    });
    let all = pores.chain([soup()]).collect::<Vec<_>>().concat();
    let read = TriMesh::from_triangles(&all, MM, "porous").unwrap();
    read.mesh.require_closed().unwrap();
    let exact = 180.0 - 48.0 * 180.0 / 8000.0;
    assert!((read.report.volume.unwrap() * 1e9 / exact - 1.0).abs() < 1e-12);
}

/// A body of 180 mm³ with a cavity of 180/8 beside a crumb of 180/1000: the body stays, hollow.
#[test]
fn the_largest_body_is_kept_with_its_cavity() {
    let hole = moved(&soup(), 0.5, Vector3::new(0.3, 0.2, -0.1));
    let crumb = moved(&soup(), 0.1, Vector3::new(8.0, 0.0, 0.0));
    let all = [crumb, hole, soup()].concat();
    let read = TriMesh::from_triangles(&all, MM, "dusty").unwrap();
    assert!(read.mesh.require_closed().is_err());
    let volumes: Vec<f64> = read.mesh.shells().iter().map(|s| s.volume * 1e9).collect();
    for (found, exact) in volumes.iter().zip([180.0, 0.18, -22.5]) {
        assert!((found - exact).abs() < 1e-9, "{volumes:?}");
    }
    let body = read.mesh.largest_body().unwrap();
    assert!(body.mesh.require_closed().is_ok());
    assert!((body.report.volume.unwrap() / 157.5e-9 - 1.0).abs() < 1e-12);
}

#[test]
fn bodies_that_share_an_edge_are_refused() {
    let all = [soup(), moved(&soup(), 1.0, Vector3::new(9.0, 5.0, 0.0))].concat();
    let read = TriMesh::from_triangles(&all, MM, "touching").unwrap();
    assert!(!read.report.watertight);
    let message = read.mesh.require_closed().unwrap_err().to_string();
    assert!(message.contains("more than two triangles"), "{message}");
}

/// 9 mm read as metres and as micrometres: the likely unit is named with its factor.
#[test]
fn a_size_that_no_seed_has_brings_up_the_likely_unit() {
    let warning = |unit| {
        let read = TriMesh::from_triangles(&soup(), unit, "box").unwrap();
        read.report.warnings.first().map(ToString::to_string)
    };
    assert_eq!(warning(MM), None);
    let metres = warning(LengthUnit::Metre).unwrap();
    assert!(
        metres.contains("9000") && metres.contains("with the unit mm (factor 1e-3)"),
        "{metres}"
    );
    let small = warning(LengthUnit::Micrometre).unwrap();
    assert!(small.contains("with the unit mm"), "{small}");
}

/// Lengths in messages keep their digits in a body of 9 um.
#[test]
fn a_small_body_is_refused_with_lengths_that_say_something() {
    let open: Vec<_> = soup().split_off(1);
    let read = TriMesh::from_triangles(&open, LengthUnit::Micrometre, "small").unwrap();
    let message = read.mesh.require_closed().unwrap_err().to_string();
    assert!(!message.contains("0.0000"), "{message}");
    // The hole is half of the side of 9 x 5 um: sqrt(106) um across.
    assert!(message.contains("the widest 0.01030 mm"), "{message}");
}

/// A seed whose tip is pushed in so far that it comes out at the other end: one closed shell,
/// oriented, with a part of negative volume. Of the pushed part, which begins at x = 0.3 and reaches
/// -4.35, what lies beyond the far end at -3 is at least the last tenth of the length of the seed:
/// 2 % of the area and more.
#[test]
fn a_surface_that_cuts_itself_is_named_and_refused() {
    let whole = soup_of(&shapes::ellipsoid([3.0, 1.5, 1.5], 16).unwrap());
    let pushed = |c: Vector3<f64>| Vector3::new(c.x - 3.5 * (c.x - 0.9).max(0.0), c.y, c.z);
    let soup: Vec<_> = whole.iter().map(|t| t.map(pushed)).collect();
    let read = TriMesh::from_triangles(&soup, MM, "pushed").unwrap();
    let topology = read.mesh.topology();
    assert!(topology.watertight() && topology.shells == 1);
    let crosses = |warning: &Warning| matches!(warning, Warning::Crossings { .. });
    assert!(read.report.warnings.iter().any(crosses));
    let share = topology.folded_share;
    assert!(share > 0.02 && share < 0.5, "{share}");
    let error = read.mesh.require_closed().unwrap_err();
    assert!(matches!(error, Error::CutsItself { .. }), "{error}");
    let message = error.to_string();
    assert!(
        message.contains("pushed cuts itself") && message.contains("repair it"),
        "{message}"
    );
    let read = TriMesh::from_triangles(&whole, MM, "whole").unwrap();
    assert_eq!(read.mesh.topology().crossings, 0);
}

/// A ring of 0.5 whose tube of radius 1 reaches over its own axis meets itself in two points only,
/// and parts inside from outside everywhere: it is a body with a cavity, of 2 pi 0.5 pi mm³ (the
/// facets take 1 to 2 % away).
#[test]
fn a_surface_that_meets_itself_in_points_is_a_body() {
    let ring = soup_of(&shapes::torus(3.0, 1.0, 60, 61).unwrap());
    let narrowed = |c: Vector3<f64>| {
        let from_axis = c.x.hypot(c.y);
        let factor = (from_axis - 2.5) / from_axis;
        Vector3::new(c.x * factor, c.y * factor, c.z)
    };
    let spindle: Vec<_> = ring.iter().map(|t| t.map(narrowed)).collect();
    let read = TriMesh::from_triangles(&spindle, MM, "spindle").unwrap();
    let topology = read.mesh.topology();
    assert!(topology.crossings > 0 && topology.folded_share < 0.01);
    assert!(read.mesh.require_closed().is_ok());
    let volume = read.report.volume.unwrap() * 1e9;
    assert!(
        (volume / (std::f64::consts::PI * std::f64::consts::PI) - 1.0).abs() < 0.02,
        "{volume}"
    );
}

/// Two spikes of a scan that lean through each other: told, but too small to matter.
#[test]
fn a_small_crossing_is_told_and_let_pass() {
    let mut soup = soup_of(&shapes::ellipsoid([4.5, 2.5, 2.0], 48).unwrap());
    let nearest = |to: Vector3<f64>| {
        let far = |c: &Vector3<f64>| (c - to).norm_squared();
        let corners = soup.iter().flatten().copied();
        corners.min_by(|a, b| far(a).total_cmp(&far(b))).unwrap()
    };
    let (a, b) = (
        nearest(Vector3::new(0.0, 0.0, 2.0)),
        nearest(Vector3::new(0.3, 0.0, 2.0)),
    );
    let lean = (b - a) * 1.2;
    let rise = Vector3::new(0.0, 0.0, 0.3);
    for corner in soup.iter_mut().flatten() {
        if *corner == a {
            *corner += lean + rise;
        } else if *corner == b {
            *corner += rise - lean;
        }
    }
    let read = TriMesh::from_triangles(&soup, MM, "spiky").unwrap();
    let topology = read.mesh.topology();
    assert!(topology.crossings > 0);
    assert!(topology.folded_share < 0.005, "{}", topology.folded_share);
    assert!(read.mesh.require_closed().is_ok());
}
