//! From arguments to results.

use crate::arguments::{Arguments, ModeName};
use crate::page::page;
use crate::results::{ImageResult, Output};
use crate::ruler::{MeasuredPicture, Opened, Ruler};
use crate::summary::Summary;
use crate::table::csv;
use command_line::{DONE, ERROR, Header, NOT_MET, write_new};
use photo_profile::{Mode, PictureFiles, Posture, Settings, one_of, sideways};
use std::path::{Path, PathBuf};

/// Measures all pictures and says what came out; returns the exit code.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    let settings = arguments.settings()?;
    let mut found = PictureFiles::find(&arguments.photos, arguments.mask.as_deref())?;
    let (files, step) = one_of(arguments.every, std::mem::take(&mut found.files));
    anyhow::ensure!(
        arguments.surface.is_none() || files.len() == 1 && arguments.mode == ModeName::Drum,
        "--surface states the surface of one picture of a drum: give one file, without --mode heap"
    );
    try_outputs(arguments, &files)?;
    let ruler = Ruler::new(arguments, settings, files.len(), step)?;
    let mut measured = Measured::default();
    measured.all(&ruler, &files)?;
    let rate = arguments.fps.or(measured.film_rate);
    let interval = rate.map(|rate| arguments.every.get() as f64 / rate);
    if let Some(interval) = interval {
        for (place, image) in measured.images.iter_mut().enumerate() {
            image.time_s = Some(place as f64 * interval);
        }
    }
    report(arguments, &settings, measured, &found, interval)
}

/// What was measured so far.
#[derive(Default)]
struct Measured {
    images: Vec<ImageResult>,
    /// The pictures of the page; none for a file that could not be read, and if no page is asked for.
    shown: Vec<Option<Vec<u8>>>,
    /// How each picture that was read was taken, and the place of its result.
    postures: Vec<(usize, Posture)>,
    /// Pictures a second of the one film, as it states.
    film_rate: Option<f64>,
}

impl Measured {
    /// Measures all files in order, several at a time.
    fn all(&mut self, ruler: &Ruler<'_>, files: &[PathBuf]) -> anyhow::Result<()> {
        for some in files.chunks(ruler.at_once()) {
            for (file, outcome) in some.iter().zip(ruler.open_all(some)) {
                ruler
                    .arguments
                    .common
                    .log(|| format!("reading {}", file.display()));
                let before = self.images.len();
                let outcome = outcome.and_then(|opened| self.take(ruler, opened, files.len()));
                let Err(error) = outcome else { continue };
                // One bad file among others must not cost the others, nor the end of a film its beginning.
                if files.len() == 1 && self.images.len() == before {
                    return Err(error);
                }
                let reason = format!("{error:#}");
                let result = ImageResult::unread(file, reason, &ruler.settings);
                ruler.arguments.common.print(result.text())?;
                self.images.push(result);
                self.shown.push(None);
            }
        }
        Ok(())
    }

    /// Takes over the pictures of one file.
    fn take(&mut self, ruler: &Ruler<'_>, opened: Opened, n_files: usize) -> anyhow::Result<()> {
        match opened {
            Opened::Read { pictures, several } => pictures
                .into_iter()
                .try_for_each(|picture| self.add(ruler, picture, several || n_files > 1)),
            Opened::Film(mut film) => {
                self.film_rate = film.rate().filter(|_| n_files == 1);
                while let Some(pictures) = film.next_pictures(ruler)? {
                    for picture in pictures {
                        self.add(ruler, picture, true)?;
                    }
                }
                Ok(())
            }
        }
    }

    /// Says what a picture gave and keeps it; of several, the name of the overlay gets a number.
    fn add(
        &mut self,
        ruler: &Ruler<'_>,
        picture: MeasuredPicture,
        several: bool,
    ) -> anyhow::Result<()> {
        let common = &ruler.arguments.common;
        if let (Some(out), Some(png)) = (&ruler.arguments.overlay, picture.overlay) {
            let number = self.images.len() + 1;
            let name = if several {
                numbered(out, number)
            } else {
                out.clone()
            };
            write_new(&name, &png, common.overwrite())?;
        }
        common.print(picture.result.text())?;
        self.postures.push((self.images.len(), picture.posture));
        self.images.push(picture.result);
        self.shown.push(picture.shown);
        Ok(())
    }
}

/// Refuses overlays that are not PNG, results in the place of a picture to be read, and results that cannot be written,
/// before any work is done.
///
/// How many frames an animation has is not known here; a later overlay that exists stops the run.
fn try_outputs(arguments: &Arguments, files: &[PathBuf]) -> anyhow::Result<()> {
    if let Some(out) = &arguments.overlay {
        anyhow::ensure!(
            out.extension()
                .is_some_and(|end| end.eq_ignore_ascii_case("png")),
            "--overlay {}: the picture is written as PNG; give a name that ends in .png",
            out.display()
        );
    }
    let n_files = files.len();
    let overlays = arguments.overlay.iter().flat_map(|out| {
        let several = (1..=n_files).map(|number| numbered(out, number));
        several
            .filter(move |_| n_files > 1)
            .chain((n_files == 1).then(|| out.clone()))
    });
    let outputs: Vec<PathBuf> = overlays
        .chain(arguments.csv.clone())
        .chain(arguments.html.clone())
        .collect();
    arguments.common.try_outputs_beside(files, &outputs)
}

/// The name with a number before its ending: `out.png` becomes `out-003.png`.
fn numbered(out: &Path, number: usize) -> PathBuf {
    let stem = out
        .file_stem()
        .map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    out.with_file_name(format!("{stem}-{number:03}.png"))
}

/// Writes the summary and the files that are asked for; returns the exit code. `found` holds what was left out, `interval` is the
/// time between pictures, s.
fn report(
    arguments: &Arguments,
    settings: &Settings,
    measured: Measured,
    found: &PictureFiles,
    interval: Option<f64>,
) -> anyhow::Result<u8> {
    let Measured {
        mut images,
        shown,
        postures,
        ..
    } = measured;
    let (places, postures): (Vec<usize>, Vec<Posture>) = postures.into_iter().unzip();
    for (k, why) in sideways(&postures) {
        let image = &mut images[places[k]];
        let warning = format!("may lie on its side: {why}; turn it upright, or take it out");
        arguments
            .common
            .print(format!("{}: {warning}", image.name()))?;
        image.warning = Some(warning);
    }
    let summary = Summary::new(&images, interval, settings);
    if images.len() > 1 {
        arguments.common.print(summary.text())?;
    }
    let left_out = found.remark();
    if let Some(words) = &left_out {
        arguments.common.print(words)?;
    }
    let single = match images.as_slice() {
        [one] => Some(one.clone()),
        _ => None,
    };
    let read = images.iter().filter(|i| i.sha256.is_some());
    let output = Output {
        header: Header::new(None::<u64>, read.map(|i| &i.file))?,
        camera_roll_deg: settings.camera_roll.to_degrees(),
        single,
        images,
        left_out,
        skipped: {
            let left_out = found.left_out.iter();
            left_out
                .map(|left| left.file.display().to_string())
                .collect()
        },
        summary,
    };
    write_files(
        arguments,
        &output,
        &shown,
        settings.mode,
        interval.is_some(),
    )?;
    let summary = &output.summary;
    Ok(if summary.unread == output.images.len() {
        ERROR
    } else if summary.refused + summary.unread > 0 {
        NOT_MET
    } else {
        DONE
    })
}

/// Writes the table, the page and the JSON that are asked for.
fn write_files(
    arguments: &Arguments,
    output: &Output,
    shown: &[Option<Vec<u8>>],
    mode: Mode,
    timed: bool,
) -> anyhow::Result<()> {
    if let Some(file) = &arguments.csv {
        let text = csv(&output.images, mode, timed);
        let bytes = command_line::table_file::bytes_for(file, &text)?;
        write_new(file, &bytes, arguments.common.overwrite())?;
    }
    if let Some(file) = &arguments.html {
        let text = page(output, shown, mode)?;
        write_new(file, text.as_bytes(), arguments.common.overwrite())?;
    }
    arguments.common.emit_json(output)
}
