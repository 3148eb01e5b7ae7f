//! The table of errors, refusals and coverage over drawn pictures.
//!
//! `cargo run --release -p photo-profile --example angle_trials -- [PICTURES_A_KIND] [KIND]`
//! prints a Markdown table; the pictures are the same each time.

#![expect(clippy::print_stdout, reason = "the table is the result")]

use dev_support::drawn_pictures::{Class, HeapScene, Kind, Trial, kinds};
use photo_profile::{DrumReading, Mode, PhotoReading, Settings, measure_image};
use std::collections::BTreeMap;
use surface_profile::{measure, measure_heap};

/// One measured picture: error and stated standard error for line, middle and chord, degrees.
type Measured = [[f64; 2]; 3];

/// Result of one picture.
enum Outcome {
    /// Measured.
    Measured(Measured),
    /// Refused, by the variant of the reason.
    Refused(String),
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let each: u64 = arguments.next().and_then(|a| a.parse().ok()).unwrap_or(100);
    let only = arguments.next();
    println!(
        "| kind | class | n | refused | bias | rms | median | worst | cover | off | mid median | mid \
         cover | chord median | chord cover |"
    );
    println!("|---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|");
    let mut classes: BTreeMap<&str, Vec<Outcome>> = BTreeMap::new();
    for kind in kinds() {
        if only
            .as_ref()
            .is_some_and(|name| !kind.name.contains(name.as_str()))
        {
            continue;
        }
        let outcomes = run(&kind, each, only.is_some());
        row(kind.name, class(&kind), &outcomes);
        classes.entry(class(&kind)).or_default().extend(outcomes);
    }
    if only.as_ref().is_none_or(|name| name == "heap") {
        heaps(each);
    }
    for (name, outcomes) in classes {
        row("all", name, &outcomes);
    }
}

/// Measures heaps and prints their rows: both flanks of each count as one picture.
fn heaps(each: u64) {
    heap_rows("heap", each, plain_heap);
    heap_rows("heap in a hard picture", each, hard_heap);
}

/// A part of 1 that fills it evenly as the number of the picture grows.
fn part(number: u64, step: f64) -> f64 {
    (number as f64 * step).fract()
}

/// A bumpy heap on a table of its tone or of another.
fn plain_heap(number: u64) -> HeapScene {
    let part = |step: f64| part(number, step);
    let dark = number.is_multiple_of(2);
    HeapScene {
        flanks: [0.35 + 0.5 * part(0.754_878), 0.35 + 0.5 * part(0.569_840)],
        tones: if dark {
            [60.0, 210.0, 40.0]
        } else {
            [200.0, 30.0, 120.0]
        },
        apex: [0.4 + 0.2 * part(0.682_328), 0.2],
        rounding: 0.02 * part(0.317),
        bumps: 0.006 * part(0.414),
        blur: 0.7 + 2.0 * part(0.732),
        noise: 10.0 * part(0.236),
        seed: number,
        ..HeapScene::default()
    }
}

/// A heap that is harder to read: on a white table, leaning, with dust and more noise, and with a foot that spreads or a camera
/// above it.
fn hard_heap(number: u64) -> HeapScene {
    let part = |step: f64| part(number, step);
    let above = number.is_multiple_of(3);
    let flank = 0.4 + 0.4 * part(0.754_878);
    HeapScene {
        flanks: [flank; 2],
        tones: [70.0, 200.0, 200.0],
        apex: [0.5, 0.2],
        noise: 5.0 + 15.0 * part(0.236),
        spread: if above { 0.0 } else { 0.4 * part(0.618) },
        elevation: if above { 0.2 * part(0.141) } else { 0.0 },
        lean: 0.12 * (part(0.271) - 0.5),
        specks: 20,
        ..plain_heap(number)
    }
}

/// Measures heaps of one kind, where roll and elevation of the camera are known.
fn heap_rows(name: &str, each: u64, draw: impl Fn(u64) -> HeapScene) {
    let mut outcomes = Vec::new();
    let mut against_straight = Vec::new();
    for seed in 0..each {
        let scene = draw(seed);
        let settings = Settings {
            mode: Mode::Heap,
            camera_roll: scene.lean,
            camera_elevation: Some(scene.elevation),
            // Each flank represents itself.
            max_angle_error: 0.5,
            ..Settings::default()
        };
        let reading = measure_image(&scene.draw(), &settings);
        let Ok(PhotoReading::Heap(heap)) = reading else {
            outcomes.push(Outcome::Refused("heap".to_owned()));
            continue;
        };
        let level = HeapScene {
            lean: 0.0,
            elevation: 0.0,
            ..scene
        };
        let Ok(truth) = measure_heap(&level.outline()) else {
            continue;
        };
        let flanks = [
            (heap.left, truth.left, heap.left_standard_error),
            (heap.right, truth.right, heap.right_standard_error),
        ];
        for ((angle, truth, error), straight) in flanks.into_iter().zip(scene.flanks) {
            let none = [f64::NAN; 2];
            let pair = |truth: f64| [(angle - truth).to_degrees(), error.to_degrees()];
            outcomes.push(Outcome::Measured([pair(truth.inclination), none, none]));
            against_straight.push(Outcome::Measured([pair(straight), none, none]));
        }
    }
    row(&format!("{name}, a flank each"), "heap", &outcomes);
    row(
        "the same, to the flank far from the top",
        "heap",
        &against_straight,
    );
}

/// Name of a class.
fn class(kind: &Kind) -> &'static str {
    match kind.class {
        Class::Clean => "clean",
        Class::Hard => "hard",
        Class::Hopeless => "hopeless",
    }
}

/// Measures the pictures of a kind on two threads.
fn run(kind: &Kind, each: u64, tell: bool) -> Vec<Outcome> {
    let half = |first: u64| -> Vec<Outcome> {
        (first..each)
            .step_by(2)
            .map(|k| one(&kind.trial(k), tell.then_some(k)))
            .collect()
    };
    std::thread::scope(|scope| {
        let odd = scope.spawn(|| half(1));
        let mut all = half(0);
        all.extend(odd.join().unwrap_or_default());
        all
    })
}

/// Measures one picture.
fn one(trial: &Trial, tell: Option<u64>) -> Outcome {
    let outcome = match measure_image(&trial.picture, &Settings::default()) {
        Err(error) => Outcome::Refused(error.to_string()),
        Ok(reading) => match reading {
            PhotoReading::Refused(refused) => Outcome::Refused(format!("{:?}", refused.reason)),
            PhotoReading::Heap(_) => Outcome::Refused("a heap".to_owned()),
            PhotoReading::Drum(DrumReading { angle, .. }) => {
                match measure(&trial.scene.surface(), &trial.scene.drum()) {
                    Err(_) => Outcome::Measured([[f64::NAN; 2]; 3]),
                    Ok(truth) => {
                        let sign = if angle.high_side == truth.high_side {
                            1.0
                        } else {
                            -1.0
                        };
                        let pair = |a: f64, b: f64, se: f64| {
                            [(sign * a - b).to_degrees(), se.to_degrees()]
                        };
                        Outcome::Measured([
                            pair(angle.line, truth.line, angle.standard_error),
                            pair(angle.mid, truth.mid, angle.mid_standard_error),
                            pair(angle.chord, truth.chord, angle.chord_standard_error),
                        ])
                    }
                }
            }
        },
    };
    if let Some(number) = tell {
        match &outcome {
            Outcome::Refused(reason) => println!("{number}: {reason}"),
            Outcome::Measured(all) => println!("{number}: {all:.3?}"),
        }
    }
    outcome
}

/// Prints one row of the table.
fn row(name: &str, class: &str, outcomes: &[Outcome]) {
    let measured: Vec<Measured> = outcomes
        .iter()
        .filter_map(|o| match o {
            Outcome::Measured(all) => Some(*all),
            Outcome::Refused(_) => None,
        })
        .collect();
    let refused = outcomes.len() - measured.len();
    let n = measured.len() as f64;
    let share = |which: usize, far: f64| {
        if measured.iter().any(|m| m[which][0].is_nan()) {
            return f64::NAN;
        }
        let inside = measured
            .iter()
            .filter(|m| m[which][0].abs() <= far * m[which][1]);
        100.0 * inside.count() as f64 / n
    };
    let median = |which: usize| {
        let mut sizes: Vec<f64> = measured.iter().map(|m| m[which][0].abs()).collect();
        sizes.sort_by(f64::total_cmp);
        sizes.get(sizes.len() / 2).copied().unwrap_or(f64::NAN)
    };
    let errors = measured.iter().map(|m| m[0][0]);
    let bias = errors.clone().sum::<f64>() / n;
    let rms = (errors.clone().map(|e| e * e).sum::<f64>() / n).sqrt();
    let worst = errors.map(f64::abs).fold(0.0, f64::max);
    let off = measured
        .iter()
        .filter(|m| m[0][0].abs() > 1.0 && m[0][0].abs() > 3.0 * m[0][1])
        .count();
    let number = |value: f64, digits: usize| {
        if value.is_nan() || measured.is_empty() {
            "-".to_owned()
        } else {
            format!("{value:.digits$}")
        }
    };
    println!(
        "| {name} | {class} | {} | {refused} | {} | {} | {} | {} | {} | {off} | {} | {} | {} | {} |",
        outcomes.len(),
        number(bias, 3),
        number(rms, 3),
        number(median(0), 3),
        number(worst, 2),
        number(share(0, 1.96), 1),
        number(median(1), 3),
        number(share(1, 1.96), 1),
        number(median(2), 3),
        number(share(2, 1.96), 1),
    );
}
