//! Readers fed with damaged bytes: an answer or an error, never a panic, never a huge mesh.
//!
//! The cases are the same every time. `trials/checks.sh fuzz-meshes` runs eight hundred times as many, which
//! takes about ten minutes.

use probability::random_stream::Stream;
use trimesh::{LengthUnit, SignedDistance, parse_mesh, shapes};

/// Cases of a plain test run: about a second.
const CASES: u64 = 200_000;

/// Cases of the long run.
const MANY_CASES: u64 = 160_000_000;

/// A small ball as binary STL, ASCII STL, OBJ and PLY of three encodings.
fn whole_files() -> Vec<Vec<u8>> {
    let ball = shapes::ellipsoid([3.0, 2.0, 1.0], 2).expect("a mesh");
    let soup: Vec<_> = (0..ball.triangles().len())
        .map(|t| ball.corners(t))
        .collect();
    let mut stl = vec![b' '; 80];
    stl.extend(u32::try_from(soup.len()).expect("few").to_le_bytes());
    let mut ascii = String::from("solid ball\n");
    for corners in &soup {
        stl.extend([0; 12]);
        ascii += "facet normal 0 0 1\nouter loop\n";
        for c in corners {
            #[expect(
                clippy::cast_possible_truncation,
                reason = "the format is single precision"
            )]
            stl.extend([c.x, c.y, c.z].map(|v| (v as f32).to_le_bytes()).concat());
            ascii.extend([format!("vertex {} {} {}\n", c.x, c.y, c.z)]);
        }
        stl.extend([0; 2]);
        ascii += "endloop\nendfacet\n";
    }
    ascii += "endsolid ball\n";
    let n = (ball.vertices().len(), ball.triangles().len());
    let mut obj = String::new();
    let head = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex {}\nproperty double x\nproperty double y\n\
             property double z\nelement face {}\nproperty list uchar uint vertex_index\nend_header\n",
            n.0, n.1
        )
    };
    let mut ply = head("ascii");
    let mut little = head("binary_little_endian").into_bytes();
    let mut big = head("binary_big_endian").into_bytes();
    for v in ball.vertices() {
        obj.extend([format!("v {} {} {}\n", v.x, v.y, v.z)]);
        ply.extend([format!("{} {} {}\n", v.x, v.y, v.z)]);
        little.extend([v.x, v.y, v.z].map(f64::to_le_bytes).concat());
        big.extend([v.x, v.y, v.z].map(f64::to_be_bytes).concat());
    }
    for t in ball.triangles() {
        let index = t.map(|i| u32::try_from(i).expect("few"));
        obj.extend([format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1)]);
        ply.extend([format!("3 {} {} {}\n", t[0], t[1], t[2])]);
        little.push(3);
        little.extend(index.map(u32::to_le_bytes).concat());
        big.push(3);
        big.extend(index.map(u32::to_be_bytes).concat());
    }
    vec![stl, ascii.into(), obj.into(), ply.into(), little, big]
}

/// Damages some bytes: other values, cuts, insertions, swaps of long parts.
fn damage(bytes: &mut Vec<u8>, stream: &mut Stream) {
    const WORDS: [&[u8]; 10] = [
        b"nan",
        b"1e999",
        b"-1",
        b"4294967295",
        b"solid",
        b"facet",
        b"\r",
        b"ply\n",
        b"0",
        b"\x00\xFF",
    ];
    for _ in 0..=stream.below(4) {
        if bytes.is_empty() {
            return;
        }
        let place = stream.below(bytes.len());
        match stream.below(6) {
            0 => bytes[place] ^= 1 << stream.below(8),
            1 => bytes[place] = u8::try_from(stream.below(256)).expect("a byte"),
            2 => bytes.truncate(place),
            3 => {
                let word = WORDS[stream.below(WORDS.len())];
                bytes.splice(place..place, word.iter().copied());
            }
            4 => {
                let end = (place + stream.below(60)).min(bytes.len());
                bytes.drain(place..end);
            }
            _ => {
                let end = (place + stream.below(200)).min(bytes.len());
                let part = bytes[place..end].to_vec();
                bytes.splice(place..place, part);
            }
        }
    }
}

/// What is read must keep the invariants of a mesh, and answer a distance query.
fn read(bytes: Vec<u8>, name: &str) -> bool {
    let length = bytes.len();
    let Ok(found) = parse_mesh(bytes, LengthUnit::Millimetre, name) else {
        return false;
    };
    let mesh = found.mesh;
    // The shortest polygon of three corners takes six bytes ("f 1 2 3" is longer).
    assert!(mesh.triangles().len() <= length / 2);
    for t in 0..mesh.triangles().len() {
        for corner in mesh.corners(t) {
            assert!(corner.iter().all(|value| value.is_finite()));
        }
    }
    if let Ok(distance) = SignedDistance::new(&mesh) {
        let middle = mesh.bounding_box().centre();
        assert!(distance.distance(&middle).is_finite());
        assert!(mesh.moments().volume.is_finite());
    }
    true
}

/// Damages and reads a number of files.
fn run(cases: u64) {
    let files = whole_files();
    for (file, name) in files.iter().zip(["stl", "stl", "obj", "ply", "ply", "ply"]) {
        assert!(read(file.clone(), &format!("whole.{name}")));
    }
    let mut accepted = 0_u64;
    for case in 0..cases {
        let mut stream = Stream::new(case, "mutated files");
        let mut bytes = files[stream.below(files.len())].clone();
        damage(&mut bytes, &mut stream);
        let name = ["a.stl", "a.obj", "a.ply", "a"][stream.below(4)];
        accepted += u64::from(read(bytes, name));
    }
    // Some damage is harmless, most is not; both must occur for the test to say anything.
    assert!(
        accepted > cases / 100 && accepted < cases,
        "{accepted} of {cases}"
    );
}

#[test]
fn damaged_bytes_never_break_a_reader() {
    run(CASES);
}

#[test]
#[ignore = "takes ten minutes: trials/checks.sh fuzz-meshes"]
fn many_damaged_bytes_never_break_a_reader() {
    run(MANY_CASES);
}
