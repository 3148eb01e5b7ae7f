//! Damaged files on the way from the decoder to the angle: an error, a refusal or a number, and
//! never a panic or a hang.
//!
//! `MUTATIONS=100000 cargo test --release -p photo-profile --test mutated_files` tries more of
//! them than the few of every test run.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use image::{DynamicImage, ImageFormat};
use photo_profile::synthetic::Scene;
use photo_profile::{Mode, PhotoPixels, Settings, measure_photo, read_frames};
use std::path::PathBuf;

/// The splittable counter hash of `[Steele2014]`.
struct Stream(u64);

impl Stream {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        usize::try_from((z ^ (z >> 31)) % n as u64).unwrap()
    }

    fn byte(&mut self) -> u8 {
        u8::try_from(self.below(256)).unwrap()
    }
}

/// Some bytes replaced, a stretch cut out, repeated or zeroed, or the end lost.
fn damaged(whole: &[u8], random: &mut Stream) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    for _ in 0..=random.below(3) {
        let n = bytes.len().max(2);
        let (from, length) = (random.below(n - 1), 1 + random.below(n / 4 + 1));
        let to = (from + length).min(bytes.len());
        match random.below(6) {
            // Headers decide most, so they are hit more often.
            0 | 1 => {
                let header = n.min(64);
                let place = random.below(header);
                bytes[place] = random.byte();
            }
            2 => bytes[from] = random.byte(),
            3 => drop(bytes.drain(from..to)),
            4 => bytes[from..to].fill(random.byte()),
            _ => bytes.truncate(from.max(8)),
        }
        if bytes.len() < 2 {
            break;
        }
    }
    bytes
}

#[test]
fn a_damaged_file_gives_an_error_a_refusal_or_a_number() {
    try_damaged_files(400);
}

/// Ten minutes of the same: `cargo test --release -p photo-profile --test mutated_files -- --ignored`.
#[test]
#[ignore = "takes ten minutes"]
fn many_damaged_files_give_an_error_a_refusal_or_a_number() {
    try_damaged_files(96_000);
}

fn try_damaged_files(tries: usize) {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("damaged-{tries}"));
    std::fs::create_dir_all(&folder).unwrap();
    let scene = Scene {
        size: 120,
        radius: 52.0,
        blur: 1.0,
        noise: 3.0,
        ..Scene::default()
    };
    let picture = DynamicImage::ImageLuma8(scene.draw()).to_rgb8();
    let formats = [
        ImageFormat::Png,
        ImageFormat::Jpeg,
        ImageFormat::Bmp,
        ImageFormat::Gif,
    ];
    let wholes: Vec<Vec<u8>> = formats
        .iter()
        .map(|format| {
            let mut bytes = std::io::Cursor::new(Vec::new());
            picture.write_to(&mut bytes, *format).unwrap();
            bytes.into_inner()
        })
        .collect();
    let mut random = Stream(7);
    let (mut errors, mut read) = (0, 0);
    for number in 0..tries {
        let bytes = damaged(&wholes[number % wholes.len()], &mut random);
        let path = folder.join("damaged.bin");
        std::fs::write(&path, bytes).unwrap();
        let Ok(frames) = read_frames(&path) else {
            errors += 1;
            continue;
        };
        read += 1;
        // A header may promise a huge picture that decodes: its size is refused elsewhere.
        for frame in frames.iter().filter(|f| f.width().max(f.height()) < 2000) {
            for mode in [Mode::Drum, Mode::Heap] {
                let settings = Settings {
                    mode,
                    ..Settings::default()
                };
                let reading = measure_photo(&PhotoPixels::from_picture(frame), &settings).unwrap();
                if let Some(angle) = reading.angle {
                    assert!(angle.line.is_finite() && angle.standard_error.is_finite());
                }
            }
        }
    }
    assert!(
        errors > tries / 10 && read > tries / 10,
        "{errors} errors, {read} read"
    );
}
