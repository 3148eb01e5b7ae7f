//! Bodies given as stacks of slices.

use super::{json_of, path_text, seedfill, text};
use dev_support::drawn_pictures::save;
use image::{ImageBuffer, Luma};
use std::f64::consts::PI;
use std::path::Path;

/// Voxels along each side.
const N: u32 = 40;
/// Radius of the ball in the stack, voxels.
const RADIUS: f64 = 15.0;

/// A slice through a ball of 20000 in air of 1000 with an edge of two voxels, and a bright speck of one voxel in a corner of
/// one slice.
fn slice(z: u32) -> ImageBuffer<Luma<u16>, Vec<u16>> {
    let middle = 0.5 * f64::from(N - 1);
    ImageBuffer::from_fn(N, N, |x, y| {
        let off = [x, y, z].map(|k| f64::from(k) - middle);
        let depth = RADIUS - off[0].hypot(off[1]).hypot(off[2]);
        let share = (0.5 + 0.5 * depth).clamp(0.0, 1.0);
        let speck = (x, y, z) == (2, 2, 5);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "1000 to 20000"
        )]
        let level = (1000.0 + 19_000.0 * if speck { 1.0 } else { share }) as u16;
        Luma([level])
    })
}

/// Writes the stack as pictures into a folder.
fn write_pictures(folder: &Path) {
    std::fs::create_dir(folder).expect("the folder of the test");
    for z in 0..N {
        let file = folder.join(format!("slice_{z}.png"));
        save(slice(z), file).expect("the folder of the test");
    }
    std::fs::write(folder.join("notes.txt"), "of the tomograph").expect("the folder of the test");
}

/// Writes the stack as one TIFF file.
fn write_tiff(file: &Path) {
    let mut encoder = tiff::encoder::TiffEncoder::new(
        std::fs::File::create(file).expect("the folder of the test"),
    )
    .expect("the folder of the test");
    for z in 0..N {
        let slice = slice(z).into_raw();
        let gray = encoder.write_image::<tiff::encoder::colortype::Gray16>(N, N, &slice);
        gray.expect("the folder of the test");
    }
}

/// Forty pictures, or one file of forty, are the ball of 1.5 mm that was drawn. By half of the levels its volume is met to 0.3 %:
/// facets on voxels of 0.1 mm cut off 0.3 (0.1 / 1.5)^2 = 0.13 %. The threshold that is found moves an edge blurred over two voxels by less than
/// a tenth of one, 2 % of the volume; a higher one leaves less. The speck is not a body of its own.
#[test]
fn a_stack_of_slices_is_filled_as_its_body() {
    let folder = tempfile::tempdir().unwrap();
    let (pictures, tiff) = (
        folder.path().join("slices"),
        folder.path().join("stack.tif"),
    );
    write_pictures(&pictures);
    write_tiff(&tiff);
    let exact = 4.0 / 3.0 * PI * 1.5_f64.powi(3);
    let volume = |place: &Path, more: &[&str]| {
        let words = [
            path_text(place),
            "--voxel",
            "0.1mm",
            "--largest-body",
            "--radius",
            "0.3",
            "--json",
        ];
        let output = seedfill(&[&words[..], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        json_of(&output)
    };
    let [a, b] = [&pictures, &tiff].map(|place| volume(place, &[]));
    let found = |json: &serde_json::Value| json["mesh"]["volume_mm3"].as_f64().unwrap();
    assert_eq!(found(&a).to_bits(), found(&b).to_bits());
    let half = volume(&tiff, &["--voxel-threshold", "10500"]);
    assert!(
        (found(&half) / exact - 1.0).abs() < 0.003,
        "{} for {exact}",
        found(&half)
    );
    assert!(
        (found(&a) / exact - 1.0).abs() < 0.02,
        "{} for {exact}",
        found(&a)
    );
    assert_eq!(a["inputs"].as_object().unwrap().len(), 40);
    assert_eq!(b["inputs"].as_object().unwrap().len(), 1);
    let smaller = volume(&tiff, &["--voxel-threshold", "18000"]);
    assert!(found(&smaller) < 0.95 * exact, "{}", found(&smaller));
}

/// Each ends with code 2 and says the fault: a folder without the size of a voxel, one without slices, slices of two sizes, one slice alone, a
/// threshold above all, a length that is none.
#[test]
fn stacks_that_cannot_be_meant_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (pictures, empty, mixed) = (
        folder.path().join("slices"),
        folder.path().join("empty"),
        folder.path().join("mixed"),
    );
    write_pictures(&pictures);
    std::fs::create_dir(&empty).unwrap();
    std::fs::create_dir(&mixed).unwrap();
    save(slice(0), mixed.join("a.png")).unwrap();
    let other = ImageBuffer::from_pixel(N + 1, N, Luma([0_u16]));
    save(other, mixed.join("b.png")).unwrap();
    let one = mixed.join("a.png");
    let (cut, text_file) = (
        folder.path().join("cut.png"),
        folder.path().join("text.png"),
    );
    let whole = std::fs::read(&one).unwrap();
    std::fs::write(&cut, &whole[..whole.len() / 2]).unwrap();
    std::fs::write(&text_file, "no picture").unwrap();
    for (place, words, told) in [
        (&cut, &["--voxel", "0.1mm"][..], "cut.png (PNG, JPEG"),
        (&text_file, &["--voxel", "0.1mm"], "text.png (PNG, JPEG"),
        (&pictures, &[][..], "--voxel"),
        (&empty, &["--voxel", "0.1mm"], "holds no slice"),
        (&mixed, &["--voxel", "0.1mm"], "behind slices of 40 by 40"),
        (&one, &["--voxel", "0.1mm"], "one slice"),
        (
            &pictures,
            &["--voxel", "0.1mm", "--voxel-threshold", "30000"],
            "threshold 30000.0",
        ),
        (&pictures, &["--voxel", "-1mm"], "voxel"),
    ] {
        let output = seedfill(&[&[path_text(place), "--radius", "0.3"], words].concat());
        assert_eq!(output.status.code(), Some(2), "{words:?}");
        let error = text(&output.stderr);
        assert!(error.contains(told), "{words:?}: {error}");
    }
}
