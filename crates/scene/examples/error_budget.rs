//! What a camera does to the angle of a bed of rough seeds, by cause and speed.
//!
//! `cargo run --release -p scene --example error_budget -- [FRAMES] [SCENE.toml]` runs the drum at four speeds, draws
//! each frame at four times the pixels of the scene and reads it: the truth. Then the frame is
//! drawn as the scene says, one fault of a camera added at a time, and read as any photo. Prints a Markdown table: for each
//! cause and speed the mean difference from the truth and its standard error, and the standard deviation of single frames,
//! degrees.

#![expect(clippy::print_stdout, reason = "the table is the purpose")]

mod at_speed;

use at_speed::{Outcome, drum_at};
use image::codecs::jpeg::JpegEncoder;
use image::imageops::FilterType;
use image::{DynamicImage, GrayImage, Luma, imageops};
use input::quantity::Length;
use photo_profile::{DrumPixels, PhotoPixels, PhotoReading, Settings, measure_photo};
use probability::random_stream::Stream;
use scene::{Frame, RunResult, Scene, drum_picture};
use std::path::{Path, PathBuf};

/// Speeds, rpm.
const SPEEDS: [u32; 4] = [10, 20, 30, 45];
/// Frames at each speed where the user does not say.
const FRAMES: usize = 20;
/// Pixels of the truth over those of the scene.
const FINE: u32 = 4;

/// One fault of a camera.
#[derive(Debug, Clone, Copy)]
enum Fault {
    /// As the scene draws it.
    None,
    /// Half of the pixels.
    FewPixels,
    /// A blur with a standard deviation of this part of the radius.
    Blur(f64),
    /// Grey noise with this standard deviation, levels of 255.
    Noise(f64),
    /// Kept as JPEG with this quality.
    Jpeg(u8),
    /// Light that falls by this part from left to right.
    Light(f64),
    /// A camera this far off the axis to the side, degrees: the drum is narrower by its cosine.
    Aside(f64),
    /// A circle stated too high by this part of the radius.
    Circle(f64),
    /// A camera at this distance from the front cover, radii.
    Near(f64),
}

/// The faults in the order of the rows.
const FAULTS: [(&str, Fault); 11] = [
    ("none", Fault::None),
    ("half of the pixels", Fault::FewPixels),
    ("blur, 1 % of the radius", Fault::Blur(0.01)),
    ("blur, 3 % of the radius", Fault::Blur(0.03)),
    ("noise, 20 of 255 levels", Fault::Noise(20.0)),
    ("JPEG of quality 30", Fault::Jpeg(30)),
    ("light falling by 40 % across", Fault::Light(0.4)),
    ("camera 5 degrees aside", Fault::Aside(5.0)),
    ("camera 10 degrees aside", Fault::Aside(10.0)),
    (
        "circle stated 2 % of the radius too high",
        Fault::Circle(0.02),
    ),
    ("camera at 5 radii", Fault::Near(5.0)),
];

fn main() -> Outcome<()> {
    let mut arguments = std::env::args().skip(1);
    let frames = arguments.next().map_or(Ok(FRAMES), |text| text.parse())?;
    let file = arguments
        .next()
        .map_or_else(|| PathBuf::from("fixtures/cotton/drum.toml"), PathBuf::from);
    let columns = std::thread::scope(|scope| {
        let runs = SPEEDS.map(|rpm| {
            let file = &file;
            scope.spawn(move || column(file, rpm, frames))
        });
        runs.map(std::thread::ScopedJoinHandle::join)
    });
    let mut cells = Vec::new();
    for column in columns {
        cells.push(column.map_err(|_| "a run stopped")??);
    }
    let heads: Vec<String> = SPEEDS.iter().map(|rpm| format!("{rpm} rpm")).collect();
    println!(
        "| fault | {} |\n|---|{}",
        heads.join(" | "),
        "--:|".repeat(SPEEDS.len())
    );
    for row in 0..cells[0].len() {
        let name = FAULTS
            .get(row)
            .map_or("stated standard error, no fault", |(name, _)| name);
        let row: Vec<&str> = cells.iter().map(|column| column[row].as_str()).collect();
        println!("| {name} | {} |", row.join(" | "));
    }
    Ok(())
}

/// The cells of one speed.
fn column(file: &Path, rpm: u32, frames: usize) -> Outcome<Vec<String>> {
    let (scene, result) = drum_at(file, rpm, false, frames)?;
    let mut differences: Vec<Vec<f64>> = vec![Vec::new(); FAULTS.len()];
    let mut stated = Vec::new();
    let mut refused = vec![0_usize; FAULTS.len()];
    for (number, frame) in result.frames.iter().enumerate() {
        let mut fine = scene.clone();
        fine.camera.pixels = FINE * scene.camera.pixels;
        let picture = picture_of(&fine, &result, frame)?;
        let Some(truth) = line(&measure(&picture, None)?) else {
            continue;
        };
        for (k, (_, fault)) in FAULTS.iter().enumerate() {
            let reading = with_fault(&scene, &result, frame, *fault, number)?;
            match line(&reading) {
                Some(line) => differences[k].push(line - truth),
                None => refused[k] += 1,
            }
            if k == 0 {
                stated.extend(reading.angle().map(|a| a.standard_error.to_degrees()));
            }
        }
    }
    let mut cells: Vec<String> = differences.iter().map(|values| cell(values)).collect();
    for (cell, refused) in cells.iter_mut().zip(refused).filter(|(_, n)| *n > 0) {
        *cell = format!("{cell}, {refused} refused");
    }
    cells.push(format!(
        "{:.2}",
        stated.iter().sum::<f64>() / stated.len() as f64
    ));
    Ok(cells)
}

/// The picture of a frame by the camera of a scene.
fn picture_of(scene: &Scene, result: &RunResult, frame: &Frame) -> Outcome<GrayImage> {
    Ok(DynamicImage::from(drum_picture(scene, &result.bodies, frame)?).into_luma8())
}

/// Reads a picture.
fn measure(picture: &GrayImage, drum: Option<DrumPixels>) -> Outcome<PhotoReading> {
    let settings = Settings {
        drum,
        ..Settings::default()
    };
    Ok(measure_photo(&PhotoPixels::from_gray(picture), &settings)?)
}

/// The line through the surface, degrees.
fn line(reading: &PhotoReading) -> Option<f64> {
    reading.angle().map(|angle| angle.line.to_degrees())
}

/// Draws and reads a frame with a fault.
fn with_fault(
    scene: &Scene,
    result: &RunResult,
    frame: &Frame,
    fault: Fault,
    number: usize,
) -> Outcome<PhotoReading> {
    let mut scene = scene.clone();
    match fault {
        Fault::FewPixels => scene.camera.pixels /= 2,
        Fault::Near(radii) => {
            scene.camera.distance = Some(Length::from_si(radii * scene.apparatus.radius())?);
        }
        _ => {}
    }
    let mut picture = picture_of(&scene, result, frame)?;
    let (width, height) = picture.dimensions();
    let mut drum = None;
    match fault {
        Fault::None | Fault::FewPixels | Fault::Near(_) => {}
        Fault::Blur(part) => {
            let radius = measure(&picture, None)?.drum().map_or(0.0, |drum| drum.r);
            #[expect(clippy::cast_possible_truncation, reason = "the blur takes f32")]
            let sd = (part * radius) as f32;
            picture = imageops::blur(&picture, sd);
        }
        Fault::Noise(sd) => {
            let mut random = Stream::new(number as u64, "noise of a camera");
            changed(&mut picture, |_, level| level + sd * random.normal());
        }
        Fault::Jpeg(quality) => {
            let mut bytes = Vec::new();
            JpegEncoder::new_with_quality(&mut bytes, quality).encode_image(&picture)?;
            picture = image::load_from_memory(&bytes)?.into_luma8();
        }
        Fault::Light(part) => changed(&mut picture, |x, level| {
            level * (1.0 - part * f64::from(x) / f64::from(width))
        }),
        Fault::Aside(degrees) => {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "below the width"
            )]
            let narrow = (f64::from(width) * degrees.to_radians().cos()).round() as u32;
            picture = imageops::resize(&picture, narrow, height, FilterType::CatmullRom);
        }
        Fault::Circle(part) => {
            drum = measure(&picture, None)?.drum().map(|found| DrumPixels {
                cy: found.cy - part * found.r,
                ..found
            });
        }
    }
    measure(&picture, drum)
}

/// Changes each grey level of a picture, by its column.
fn changed(picture: &mut GrayImage, mut change: impl FnMut(u32, f64) -> f64) {
    for (x, _, pixel) in picture.enumerate_pixels_mut() {
        let level = change(x, f64::from(pixel.0[0])).round().clamp(0.0, 255.0);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to 0..=255"
        )]
        let level = level as u8;
        *pixel = Luma([level]);
    }
}

/// Mean, its standard error, and the standard deviation of single values in brackets.
fn cell(values: &[f64]) -> String {
    match surface_profile::summarise(values) {
        Ok(s) if s.n > 1 => format!("{:+.2} +- {:.2} ({:.2})", s.mean, s.standard_error, s.sd),
        _ => "-".to_owned(),
    }
}
