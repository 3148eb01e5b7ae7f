//! The angle in the picture of a simulated bed against the angle of its spheres, by speed.
//!
//! `cargo run --release -p scene --example two_rulers -- [FRAMES] [SCENE.toml]` runs the drum at each speed
//! and prints a Markdown table: means over the frames with the standard error of the mean, degrees.
//!
//! The camera sees bed wherever any seed stands between it and the back cover; the profile of the
//! spheres asks where the bed is half as dense as inside. Three more readings tell the two apart:
//! the spheres at the density of a few seeds along the drum, and picture and spheres of the seeds
//! in each third of the width alone. The last column is the same frames seen from a camera near the drum, and the last row a
//! drum whose covers stand still.

#![expect(clippy::print_stdout, reason = "the table is the purpose")]

mod at_speed;

use at_speed::{Outcome, drum_at};
use input::quantity::Length;
use scene::{Frame, RunResult, Scene, read_frame};
use std::path::PathBuf;
use surface_profile::{
    DensitySettings, Disc, DrumCircle, bulk_level, density_of_discs, free_surface, measure,
};

/// Speeds, rpm, and whether the covers stand still.
const SPEEDS: [(u32, bool); 5] = [
    (10, false),
    (20, false),
    (30, false),
    (45, false),
    (10, true),
];
/// Distance of the near camera from the front cover, in radii of the drum.
const NEAR: f64 = 5.0;
/// Frames at each speed where the user does not say.
const FRAMES: usize = 25;
/// Level that a few seeds along the width reach, parts of the level of half of the bulk.
const FEW_SEEDS: f64 = 0.2;
/// Part of the drum radius up to which the density is read, as in the profile.
const REACH: f64 = 0.97;

fn main() -> Outcome<()> {
    let mut arguments = std::env::args().skip(1);
    let frames = arguments.next().map_or(Ok(FRAMES), |text| text.parse())?;
    let file = arguments
        .next()
        .map_or_else(|| PathBuf::from("fixtures/cotton/drum.toml"), PathBuf::from);
    println!(
        "| rpm | covers | frames | refused | picture | spheres | picture - spheres | spheres at a fifth of \
         the level - at the level | thirds: front | middle | back | thirds: picture - spheres | camera at 5 radii - far away |"
    );
    println!("|--:|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|");
    let rows = std::thread::scope(|scope| {
        let speeds = SPEEDS.map(|(rpm, at_rest)| {
            scope.spawn({
                let file = &file;
                move || row(file, rpm, at_rest, frames)
            })
        });
        speeds.map(std::thread::ScopedJoinHandle::join)
    });
    for row in rows {
        let row = row.map_err(|_| "a run stopped")??;
        println!("{row}");
    }
    Ok(())
}

/// Runs the drum at one speed and makes its row.
fn row(file: &std::path::Path, rpm: u32, at_rest: bool, frames: usize) -> Outcome<String> {
    let (scene, result) = drum_at(file, rpm, at_rest, frames)?;
    let mut columns: [Vec<f64>; 9] = Default::default();
    let mut refused = 0;
    for frame in &result.frames {
        let Some(values) = compare(&scene, &result, frame)? else {
            refused += 1;
            continue;
        };
        for (column, value) in columns.iter_mut().zip(values) {
            column.extend(value);
        }
    }
    let cells = columns.map(|values| cell(&values));
    Ok(format!(
        "| {rpm} | {} | {} | {refused} | {} |",
        if at_rest { "at rest" } else { "turning" },
        result.frames.len(),
        cells.join(" | ")
    ))
}

/// The readings of one frame in the order of the columns, degrees; none for a refused picture.
fn compare(scene: &Scene, result: &RunResult, frame: &Frame) -> Outcome<Option<[Option<f64>; 9]>> {
    let whole = read_frame(scene, &result.bodies, frame)?;
    let degrees = |angle: Option<surface_profile::SurfaceAngle>| angle.map(|a| a.line.to_degrees());
    let (Some(picture), Some(spheres)) = (degrees(whole.photo.angle()), degrees(whole.position))
    else {
        return Ok(None);
    };
    let mut near = scene.clone();
    near.camera.distance = Some(Length::from_si(NEAR * scene.apparatus.radius())?);
    let near = degrees(read_frame(&near, &result.bodies, frame)?.photo.angle());
    let few = by_level(scene, result, frame, FEW_SEEDS);
    let width = scene.apparatus.width();
    let mut thirds = [None; 3];
    let mut differences = Vec::new();
    for (k, third) in thirds.iter_mut().enumerate() {
        // The front cover is at + width / 2.
        let front = width * (0.5 - k as f64 / 3.0);
        let part = read_frame(
            scene,
            &result.bodies,
            &between(frame, front - width / 3.0, front),
        )?;
        *third = degrees(part.position);
        let pair = degrees(part.photo.angle()).zip(*third);
        differences.extend(pair.map(|(picture, spheres)| picture - spheres));
    }
    let mean = differences.iter().sum::<f64>() / differences.len() as f64;
    Ok(Some([
        Some(picture),
        Some(spheres),
        Some(picture - spheres),
        few.map(|few| few - spheres),
        thirds[0],
        thirds[1],
        thirds[2],
        (!differences.is_empty()).then_some(mean),
        near.map(|near| near - picture),
    ]))
}

/// The angle of the spheres at a part of the level of half of the bulk, degrees.
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
    let level = part * bulk_level(&density, &drum);
    let points = free_surface(&density, level, &drum, REACH).ok()?;
    measure(&points, &drum).ok().map(|a| a.line.to_degrees())
}

/// The seeds whose centre of mass lies between two depths, m.
fn between(frame: &Frame, low: f64, high: f64) -> Frame {
    let inside: Vec<usize> = (0..frame.position.len())
        .filter(|i| (low..high).contains(&frame.position[*i].z))
        .collect();
    Frame {
        time: frame.time,
        kind: inside.iter().map(|i| frame.kind[*i]).collect(),
        position: inside.iter().map(|i| frame.position[*i]).collect(),
        orientation: inside.iter().map(|i| frame.orientation[*i]).collect(),
        velocity: inside.iter().map(|i| frame.velocity[*i]).collect(),
        spin: inside.iter().map(|i| frame.spin[*i]).collect(),
    }
}

/// Mean and its standard error; correlation between frames is counted.
fn cell(values: &[f64]) -> String {
    match surface_profile::summarise(values) {
        Ok(s) if s.n > 1 => format!("{:.2} +- {:.2}", s.mean, s.standard_error),
        _ => "-".to_owned(),
    }
}
