//! Damaged files on the way from the decoder to the angle: an error, a refusal or a number, and
//! never a panic or a hang.
//!
//! The files are the same every time. `trials/checks.sh fuzz-photos` tries two hundred times as many, which
//! takes about ten minutes.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use dev_support::drawn_pictures::{Scene, save};
use image::DynamicImage;
use photo_profile::{Mode, PhotoPixels, Settings, measure_photo, read_frames};
use probability::random_stream::Stream;
use std::path::PathBuf;

fn byte(random: &mut Stream) -> u8 {
    u8::try_from(random.below(256)).unwrap()
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
                bytes[place] = byte(random);
            }
            2 => bytes[from] = byte(random),
            3 => drop(bytes.drain(from..to)),
            4 => bytes[from..to].fill(byte(random)),
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

#[test]
#[ignore = "takes ten minutes: trials/checks.sh fuzz-photos"]
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
    let wholes = ["png", "jpg", "bmp", "gif"].map(|ending| {
        let path = folder.join("whole").with_extension(ending);
        save(picture.clone(), &path).unwrap();
        std::fs::read(path).unwrap()
    });
    let mut random = Stream::new(7, "damaged files");
    let (mut errors, mut read) = (0, 0);
    for number in 0..tries {
        let bytes = damaged(&wholes[number % wholes.len()], &mut random);
        let path = folder.join("damaged.bin");
        std::fs::write(&path, bytes).unwrap();
        let frames = read_frames(&path).and_then(Iterator::collect::<Result<Vec<_>, _>>);
        let Ok(frames) = frames else {
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
                if let Some(angle) = reading.angle() {
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
