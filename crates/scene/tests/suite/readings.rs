//! What the picture of a bed of the cotton study shows beside its spheres, and what faults of a camera change: docs/two-rulers.md.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use dev_support::fixture_files::fixture;
use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, GrayImage, Luma, imageops};
use input::quantity::Length;
use photo_profile::{PhotoPixels, PhotoReading, Settings, measure_photo};
use probability::random_stream::Stream;
use scene::{FillingLibrary, Frame, Override, RunResult, Scene, drum_picture, read_frame, run};
use surface_profile::{
    DensitySettings, Disc, DrumCircle, SurfaceAngle, bulk_level, density_of_discs, free_surface,
    measure,
};

/// Level that a few seeds along the width reach, over the level of half of the bulk.
const FEW_SEEDS: f64 = 0.2;
/// Part of the drum radius up to which the density is read, as in the profile.
const REACH: f64 = 0.97;

/// The drum of the study at a speed (rpm), run for some frames.
fn drum_at(rpm: u32, covers_at_rest: bool, frames: usize) -> (Scene, RunResult) {
    let changes = [
        ("rpm", rpm.to_string()),
        ("frames", frames.to_string()),
        ("apparatus.covers_at_rest", covers_at_rest.to_string()),
        // The longer step of the study's drum is for 10 rpm.
        ("protocol.flow_step_share", "0.36".to_owned()),
        (
            "protocol.rotation_limit",
            format!("{} s", 6.0 + 0.2 * frames as f64),
        ),
    ];
    let changes = changes.map(|(name, value)| Override {
        name: name.to_owned(),
        value,
    });
    let scene = Scene::read(&fixture("cotton/drum.toml"), &changes).unwrap();
    let result = run(&scene, &FillingLibrary::default(), 1).unwrap();
    (scene, result)
}

/// The line through a surface, deg.
fn line(angle: Option<SurfaceAngle>) -> Option<f64> {
    angle.map(|angle| angle.line.to_degrees())
}

/// The angle of the spheres at a part of the level of half of the bulk, deg.
fn by_level(scene: &Scene, result: &RunResult, frame: &Frame, part: f64) -> Option<f64> {
    let drum = DrumCircle {
        x: 0.0,
        y: 0.0,
        radius: scene.apparatus.radius(),
    };
    let mut discs = Vec::new();
    for (i, position) in frame.position.iter().enumerate() {
        for sphere in result.bodies[frame.kind[i]].outer.spheres() {
            let centre = position + frame.orientation[i] * sphere.centre;
            discs.push(Disc {
                x: centre.x,
                y: centre.y,
                radius: sphere.radius,
            });
        }
    }
    let density = density_of_discs(&discs, &drum, &DensitySettings::for_drum(&drum)).ok()?;
    let points = free_surface(&density, part * bulk_level(&density, &drum), &drum, REACH).ok()?;
    line(measure(&points, &drum).ok())
}

/// Mean and its standard error, with the correlation between frames.
fn cell(values: &[f64]) -> String {
    match surface_profile::summarise(values) {
        Ok(s) if s.n > 1 => format!("{:.2} +- {:.2}", s.mean, s.standard_error),
        _ => "-".to_owned(),
    }
}

/// Picture, spheres, their difference, the spheres at a fifth of the level less those at the level, and a camera at five radii less
/// one far away, deg, by speed. With turning covers the picture reads lower by 0.5 to 2 deg: more than half of that is the other
/// level.
#[test]
#[ignore = "half an hour: `trials/checks.sh two-rulers`"]
fn two_rulers() {
    for (rpm, at_rest) in [
        (10, false),
        (20, false),
        (30, false),
        (45, false),
        (10, true),
    ] {
        let (scene, result) = drum_at(rpm, at_rest, 25);
        let mut near = scene.clone();
        near.camera.distance = Some(Length::from_si(5.0 * scene.apparatus.radius()).unwrap());
        let mut columns: [Vec<f64>; 5] = Default::default();
        for frame in &result.frames {
            let reading = read_frame(&scene, &result.bodies, frame).unwrap();
            let pair = line(reading.photo.angle()).zip(line(reading.position));
            let Some((picture, spheres)) = pair else {
                continue;
            };
            let few = by_level(&scene, &result, frame, FEW_SEEDS);
            let near = read_frame(&near, &result.bodies, frame).unwrap();
            let near = line(near.photo.angle());
            let values = [
                Some(picture),
                Some(spheres),
                Some(picture - spheres),
                few.map(|few| few - spheres),
                near.map(|near| near - picture),
            ];
            for (column, value) in columns.iter_mut().zip(values) {
                column.extend(value);
            }
        }
        let cells = columns.each_ref().map(|values| cell(values));
        println!("| {rpm} | {at_rest} | {} |", cells.join(" | "));
        let [_, _, difference, few, _] =
            columns.map(|values| surface_profile::summarise(&values).unwrap().mean);
        if !at_rest {
            assert!((-2.0..-0.5).contains(&difference), "{difference}");
            assert!(few < 0.5 * difference, "{few} of {difference}");
        }
    }
}

/// One fault of a camera.
#[derive(Debug, Clone, Copy)]
enum Fault {
    /// None.
    None,
    /// Half of the pixels.
    FewPixels,
    /// A blur with a standard deviation of 3 % of the radius.
    Blur,
    /// Grey noise with a standard deviation of 20 of 255 levels.
    Noise,
    /// Kept as JPEG of quality 30.
    Jpeg,
    /// Light that falls by 40 % from left to right.
    Light,
    /// A camera 10 degrees off the axis to the side: the drum is narrower by its cosine.
    Aside,
}

/// Faults with the largest mean difference from the truth that they may make, deg, as docs/two-rulers.md states it.
const FAULTS: [(Fault, f64); 7] = [
    (Fault::None, 0.1),
    (Fault::FewPixels, 0.1),
    (Fault::Blur, 0.5),
    (Fault::Noise, 0.1),
    (Fault::Jpeg, 0.1),
    (Fault::Light, 0.1),
    (Fault::Aside, 0.6),
];

/// The picture of a frame by the camera of a scene.
fn picture_of(scene: &Scene, result: &RunResult, frame: &Frame) -> GrayImage {
    DynamicImage::from(drum_picture(scene, &result.bodies, frame).unwrap()).into_luma8()
}

/// Reads a picture.
fn read(picture: &GrayImage) -> PhotoReading {
    measure_photo(&PhotoPixels::from_gray(picture), &Settings::default()).unwrap()
}

/// A picture of a frame with a fault.
fn with_fault(scene: &Scene, result: &RunResult, frame: &Frame, fault: Fault) -> GrayImage {
    let mut scene = scene.clone();
    if matches!(fault, Fault::FewPixels) {
        scene.camera.pixels /= 2;
    }
    let mut picture = picture_of(&scene, result, frame);
    let (width, height) = picture.dimensions();
    match fault {
        Fault::None | Fault::FewPixels => picture,
        Fault::Blur => {
            let radius = read(&picture).drum().map_or(0.0, |drum| drum.r);
            #[expect(clippy::cast_possible_truncation, reason = "the blur takes f32")]
            imageops::blur(&picture, (0.03 * radius) as f32)
        }
        Fault::Noise => {
            let mut random = Stream::new(frame.time.to_bits(), "noise of a camera");
            change(&mut picture, |_, level| level + 20.0 * random.normal());
            picture
        }
        Fault::Jpeg => {
            let mut bytes = Vec::new();
            JpegEncoder::new_with_quality(&mut bytes, 30)
                .encode_image(&picture)
                .unwrap();
            image::load_from_memory(&bytes).unwrap().into_luma8()
        }
        Fault::Light => {
            change(&mut picture, |x, level| {
                level * (1.0 - 0.4 * f64::from(x) / f64::from(width))
            });
            picture
        }
        Fault::Aside => {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "below the width"
            )]
            let narrow = (f64::from(width) * 10_f64.to_radians().cos()).round() as u32;
            imageops::resize(&picture, narrow, height, imageops::FilterType::CatmullRom)
        }
    }
}

/// Changes each grey level of a picture, by its column.
fn change(picture: &mut GrayImage, mut change: impl FnMut(u32, f64) -> f64) {
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

/// Angle of frames with a fault less that of the same frames with four times the pixels, deg, by speed.
#[test]
#[ignore = "minutes: `trials/checks.sh camera-faults`"]
fn camera_faults() {
    for rpm in [10, 20, 30, 45] {
        let (scene, result) = drum_at(rpm, false, 20);
        let mut fine = scene.clone();
        fine.camera.pixels *= 4;
        let truths: Vec<_> = result
            .frames
            .iter()
            .map(|frame| line(read(&picture_of(&fine, &result, frame)).angle()))
            .collect();
        for (fault, most) in FAULTS {
            let frames = result.frames.iter().zip(&truths);
            let differences: Vec<f64> = frames
                .filter_map(|(frame, truth)| {
                    let found = read(&with_fault(&scene, &result, frame, fault));
                    Some(line(found.angle())? - (*truth)?)
                })
                .collect();
            println!("| {rpm} rpm | {fault:?} | {} |", cell(&differences));
            let mean = surface_profile::summarise(&differences).unwrap().mean;
            assert!(mean.abs() <= most, "{fault:?} at {rpm} rpm: {mean}");
        }
    }
}
