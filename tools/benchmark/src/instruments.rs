//! What is measured beside a bed: reading a picture, filling a mesh, analysing a table, bench tests of one seed.

use crate::arguments::Arguments;
use crate::measure::{peak_memory_mib, processor_seconds};
use crate::scenes::BenchmarkScene;
use crate::seed_drum;
use anyhow::Context as _;
use dev_support::drawn_pictures::Scene;
use experiment_design::{AxialDistance, Factor, central_composite};
use image::{DynamicImage, imageops};
use photo_profile::{PhotoPixels, Settings, measure_photo};
use probability::median;
use response_surface::{Cell, Model, Observations, Weighting, box_cox, fit};
use scene::{Apparatus, FillingLibrary, Slider, Tilt};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::Path;
use std::str::FromStr;

/// Seeds of the drum whose frame is read.
const SEEDS_OF_FRAME: usize = 300;
/// Mesh that is filled, in mm.
const MESH: &str = "fixtures/stl/cotton_ellipsoidal.stl";
/// Radius of the spheres in it, m: that of the study.
const RADIUS: f64 = 0.45e-3;
/// Repeats of a bench test.
const REPEATS: usize = 2;
/// Sides of the photo, px: 12 megapixels.
const PHOTO: [u32; 2] = [4000, 3000];

/// One of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Instrument {
    /// A frame of the drum of seeds is drawn and read.
    Frame,
    /// A photo of 12 megapixels is read.
    Photo12Mp,
    /// A mesh is read and filled with spheres.
    Seedfill,
    /// A central composite design of five factors is analysed.
    Analyse,
    /// A sled of seeds is pulled over a plate of seeds.
    Sled,
    /// A seed rolls off a plate of the drum's material.
    Tilt,
}

impl Instrument {
    /// All of them.
    pub(crate) const ALL: [Self; 6] = [
        Self::Frame,
        Self::Photo12Mp,
        Self::Seedfill,
        Self::Analyse,
        Self::Sled,
        Self::Tilt,
    ];

    /// Calls of a block: the kernel counts the time of a process in steps of some milliseconds.
    pub(crate) fn block_calls(self) -> usize {
        match self {
            Self::Frame | Self::Photo12Mp | Self::Seedfill | Self::Sled | Self::Tilt => 1,
            Self::Analyse => 50,
        }
    }

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Frame => "frame",
            Self::Photo12Mp => "photo-12mp",
            Self::Seedfill => "seedfill",
            Self::Analyse => "analyse",
            Self::Sled => "sled",
            Self::Tilt => "tilt",
        }
    }
}

/// What can be measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Subject {
    /// A step of a scene.
    Scene(BenchmarkScene),
    /// A call of something beside the solver.
    Instrument(Instrument),
}

impl fmt::Display for Subject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene(scene) => scene.fmt(f),
            Self::Instrument(instrument) => f.write_str(instrument.name()),
        }
    }
}

impl FromStr for Subject {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Some(instrument) = Instrument::ALL
            .into_iter()
            .find(|instrument| instrument.name() == text)
        {
            return Ok(Self::Instrument(instrument));
        }
        let instruments = || Instrument::ALL.map(Instrument::name).join(", ");
        text.parse()
            .map(Self::Scene)
            .map_err(|e| format!("{e}, or one of {}", instruments()))
    }
}

/// What one call does; it gives its result as text, which two builds share only if they agree to the last bit.
pub(crate) type Call = Box<dyn FnMut() -> anyhow::Result<String>>;

/// Makes all that a call does not have to make itself.
pub(crate) fn prepare(arguments: &Arguments, instrument: Instrument) -> anyhow::Result<Call> {
    match instrument {
        Instrument::Frame => frame(arguments),
        Instrument::Photo12Mp => Ok(photo()),
        Instrument::Seedfill => Ok(Box::new(filled)),
        Instrument::Analyse => analysis(),
        Instrument::Sled => bench_test(arguments, |_, seeds| {
            Apparatus::Slider(Slider {
                plate: seeds,
                seed: None,
                repeats: REPEATS,
            })
        }),
        Instrument::Tilt => bench_test(arguments, |shell, _| {
            Apparatus::Tilt(Tilt {
                plate: shell,
                seed: None,
                repeats: REPEATS,
            })
        }),
    }
}

/// A bench test of the first kind of seed in the drum, by the materials of the shell and of the seeds.
fn bench_test(
    arguments: &Arguments,
    test: impl Fn(String, String) -> Apparatus,
) -> anyhow::Result<Call> {
    let scene = scene::Scene::read(&arguments.drum, &[])?;
    let (Apparatus::Drum(drum), Some(kind)) = (&scene.apparatus, scene.seed.first()) else {
        anyhow::bail!("{} holds no drum of seeds", arguments.drum.display());
    };
    let apparatus = test(drum.shell.clone(), kind.material.clone());
    let scene = scene::Scene { apparatus, ..scene };
    let (library, seed) = (FillingLibrary::default(), arguments.seed);
    Ok(Box::new(move || {
        let result = scene::run(&scene, &library, seed)?;
        Ok(format!("{:?}", result.observables))
    }))
}

/// Drawing and reading a frame of a flowing drum.
fn frame(arguments: &Arguments) -> anyhow::Result<Call> {
    let drum = seed_drum::start(arguments, SEEDS_OF_FRAME)?;
    let (frame, bodies, scene) = (drum.frame(), drum.bodies, drum.scene);
    Ok(Box::new(move || {
        let reading = scene::read_frame(&scene, &bodies, &frame)?;
        Ok(format!("{reading:?}"))
    }))
}

/// Reading a photo of coarse grains, once it is decoded.
fn photo() -> Call {
    let [width, height] = PHOTO;
    let drawn = Scene {
        size: height,
        radius: 0.45 * f64::from(height),
        grain: [40.0, 25.0],
        noise: 4.0,
        ..Scene::default()
    };
    let mut wide = image::GrayImage::from_pixel(width, height, image::Luma([20]));
    imageops::replace(&mut wide, &drawn.draw(), i64::from((width - height) / 2), 0);
    let picture = DynamicImage::from(wide);
    Box::new(move || {
        let pixels = PhotoPixels::from_picture(&picture);
        let reading = measure_photo(&pixels, &Settings::default())?;
        Ok(format!("{reading:?}"))
    })
}

/// Reading and filling a mesh.
fn filled() -> anyhow::Result<String> {
    let read = trimesh::read_mesh(Path::new(MESH), trimesh::LengthUnit::Millimetre)?;
    let filling = sphere_fill::fill(&read.mesh, &sphere_fill::FillSettings::new(RADIUS))?;
    Ok(format!("{:?}", filling.spheres))
}

/// Fitting a quadratic model in five factors, its intervals and the Box-Cox plot.
fn analysis() -> anyhow::Result<Call> {
    let factors = ["A", "B", "C", "D", "E"].map(Factor::coded_only);
    let factors = factors.into_iter().collect::<Result<Vec<_>, _>>()?;
    let design = central_composite(&factors, AxialDistance::Rotatable, 6)?;
    let response = |x: &[f64]| {
        let wave: f64 = x
            .iter()
            .zip(1..)
            .map(|(x, k)| (x * f64::from(k)).sin())
            .sum();
        40.0 + 3.0 * x[0] - 2.0 * x[1] * x[2] + x[3] * x[3] + 0.1 * wave
    };
    let cells = design.coded_rows().into_iter();
    let cells = cells
        .map(|x| Cell::single(x.clone(), response(&x)))
        .collect();
    let data = Observations::from_cells(cells)?;
    Ok(Box::new(move || {
        let model = Model::quadratic(&factors)?;
        let fitted = fit(&factors, &model, &data)?;
        let transform = box_cox(&factors, &model, &data, Weighting::Counts)?;
        Ok(format!("{fitted:?} {transform:?}"))
    }))
}

/// Cost of a call; each unit is in the name.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct InstrumentRow {
    instrument: String,
    /// Time on the processor of a call in each block.
    ms_per_call_blocks: Vec<f64>,
    /// Their median.
    ms_per_call: f64,
    /// Of the process so far.
    peak_memory_mib: f64,
}

/// Measures blocks of calls, after one that warms up.
pub(crate) fn measure(
    arguments: &Arguments,
    instrument: Instrument,
) -> anyhow::Result<InstrumentRow> {
    arguments
        .common
        .log(|| format!("measuring {}", instrument.name()));
    let mut call = prepare(arguments, instrument)
        .with_context(|| format!("cannot prepare {}", instrument.name()))?;
    let mut blocks = Vec::new();
    for number in 0..=arguments.blocks {
        let start = processor_seconds()?;
        for _ in 0..instrument.block_calls() {
            call()?;
        }
        let taken = (processor_seconds()? - start) * 1e3;
        blocks.extend((number > 0).then_some(taken / instrument.block_calls() as f64));
    }
    Ok(InstrumentRow {
        instrument: instrument.name().into(),
        ms_per_call: median(&blocks),
        ms_per_call_blocks: blocks,
        peak_memory_mib: peak_memory_mib()?,
    })
}

/// The rows as a Markdown table.
pub(crate) fn table(rows: &[InstrumentRow]) -> String {
    let head = "| call | blocks | CPU-ms per call (least to most) | peak memory so far (MiB) |\n|---|--:|--:|--:|";
    let lines = rows.iter().map(|row| {
        let least = row
            .ms_per_call_blocks
            .iter()
            .copied()
            .fold(f64::INFINITY, f64::min);
        let most = row.ms_per_call_blocks.iter().copied().fold(0.0, f64::max);
        format!(
            "| {} | {} | {:.2} ({least:.2} to {most:.2}) | {:.0} |",
            row.instrument,
            row.ms_per_call_blocks.len(),
            row.ms_per_call,
            row.peak_memory_mib
        )
    });
    let lines: Vec<_> = std::iter::once(head.to_owned()).chain(lines).collect();
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::{Instrument, Subject};
    use crate::scenes::BenchmarkScene;

    #[test]
    fn a_name_is_an_instrument_or_a_scene_and_a_wrong_one_is_told_both() {
        assert_eq!(
            "photo-12mp".parse(),
            Ok(Subject::Instrument(Instrument::Photo12Mp))
        );
        let scene = Subject::Scene(BenchmarkScene::Seeds(1200));
        assert_eq!("seeds-1200".parse(), Ok(scene));
        let told = "photo-12".parse::<Subject>().unwrap_err();
        assert!(
            told.contains("seeds-N") && told.contains("photo-12mp"),
            "{told}"
        );
    }
}
