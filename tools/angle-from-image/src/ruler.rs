//! From files to measured pictures, several at a time.

use crate::arguments::Arguments;
use crate::page::{jpeg, side};
use crate::results::{ImageResult, Origin, Points};
use anyhow::{Context as _, ensure};
use command_line::file_sha256;
use image::DynamicImage;
use image::codecs::png::PngEncoder;
use photo_profile::{
    Frames, Mask, PhotoPixels, Posture, Settings, marked, measure_given_surface, measure_photo,
    overlay, read_frames, rectify,
};
use rayon::iter::{
    IndexedParallelIterator as _, IntoParallelIterator as _, IntoParallelRefIterator as _,
    ParallelIterator as _,
};
use std::iter::StepBy;
use std::path::{Path, PathBuf};

/// Pictures that are in work for each thread: enough that none waits for the slowest of them.
const AT_ONCE: usize = 4;

/// Measures pictures as the arguments say.
pub(crate) struct Ruler<'a> {
    /// What was asked for.
    pub(crate) arguments: &'a Arguments,
    /// How a picture is read.
    pub(crate) settings: Settings,
    /// What is hidden in each picture.
    mask: Option<Mask>,
    /// Files to measure.
    n_files: usize,
    /// One picture of so many in a file is taken.
    step: usize,
    pool: rayon::ThreadPool,
}

/// What one picture gave.
pub(crate) struct MeasuredPicture {
    pub(crate) result: ImageResult,
    /// How it was taken.
    pub(crate) posture: Posture,
    /// The overlay as PNG, where it is asked for.
    pub(crate) overlay: Option<Vec<u8>>,
    /// The picture of the page as JPEG, where it is asked for.
    pub(crate) shown: Option<Vec<u8>>,
}

/// A file with pictures.
pub(crate) enum Opened {
    /// Photo or animation, measured.
    Read {
        /// Its pictures in order.
        pictures: Vec<MeasuredPicture>,
        /// Whether it is an animation.
        several: bool,
    },
    /// A film, which comes bit by bit.
    Film(Box<OpenFilm>),
}

/// A film and what was taken from it.
pub(crate) struct OpenFilm {
    /// Its pictures to measure.
    frames: StepBy<Frames>,
    /// Pictures a second, by the file.
    rate: Option<f64>,
    file: PathBuf,
    /// SHA-256 of the file.
    sha256: String,
    /// Number of the next picture, from 0.
    next: usize,
    /// Why nothing more comes, not told yet.
    broken: Option<photo_profile::Error>,
}

impl<'a> Ruler<'a> {
    /// A ruler for so many files, and for one picture of so many in each.
    pub(crate) fn new(
        arguments: &'a Arguments,
        settings: Settings,
        n_files: usize,
        step: usize,
    ) -> anyhow::Result<Self> {
        Ok(Self {
            arguments,
            settings,
            mask: arguments.mask.as_deref().map(Mask::read).transpose()?,
            n_files,
            step,
            pool: rayon::ThreadPoolBuilder::new()
                .num_threads(arguments.common.threads())
                .build()?,
        })
    }

    /// Pictures that are in work together.
    pub(crate) fn at_once(&self) -> usize {
        AT_ONCE * self.pool.current_num_threads()
    }

    /// Opens files, and measures those that are not films.
    pub(crate) fn open_all(&self, files: &[PathBuf]) -> Vec<anyhow::Result<Opened>> {
        self.pool
            .install(|| files.par_iter().map(|file| self.open(file)).collect())
    }

    /// Opens a file, and measures it where it is not a film.
    fn open(&self, file: &Path) -> anyhow::Result<Opened> {
        let frames = read_frames(file)?;
        let (several, rate) = (frames.are_several(), frames.rate());
        let sha256 = file_sha256(file)?;
        let frames = frames.step_by(self.step);
        if rate.is_some() {
            ensure!(
                self.arguments.surface.is_none(),
                "--surface states the surface of one picture, and {} is a film: save the picture that is meant as a file",
                file.display()
            );
            return Ok(Opened::Film(Box::new(OpenFilm {
                frames,
                rate,
                file: file.to_owned(),
                sha256,
                next: 0,
                broken: None,
            })));
        }
        let pictures = frames.collect::<Result<Vec<_>, _>>()?;
        ensure!(
            self.arguments.surface.is_none() || pictures.len() == 1,
            "--surface states the surface of one picture, and {} holds {}: save the one that is meant as a file of its own",
            file.display(),
            pictures.len()
        );
        let side = side(self.n_files.max(pictures.len()));
        let pictures = pictures
            .into_par_iter()
            .enumerate()
            .map(|(place, picture)| {
                let origin = Origin {
                    file: file.display().to_string(),
                    frame: several.then_some(place * self.step),
                    sha256: sha256.clone(),
                };
                self.measure(picture, origin, side)
            });
        Ok(Opened::Read {
            pictures: pictures.collect::<anyhow::Result<_>>()?,
            several,
        })
    }

    /// Measures one picture; the page shows it with this longer side, px.
    fn measure(
        &self,
        picture: DynamicImage,
        origin: Origin,
        side: u32,
    ) -> anyhow::Result<MeasuredPicture> {
        let taken = [picture.width(), picture.height()];
        let picture = match self.arguments.corners {
            Some(corners) => rectify(&picture, corners.0)?,
            None => picture,
        };
        let mut pixels = PhotoPixels::from_picture(&picture);
        if let Some(mask) = &self.mask {
            pixels = pixels.hiding(mask)?;
        }
        let reading = match &self.arguments.surface {
            Some(places) => measure_given_surface(&pixels, &places.0, &self.settings)?,
            None => measure_photo(&pixels, &self.settings)?,
        };
        let draws = self.arguments.overlay.is_some();
        let drawn = draws.then(|| png(&overlay(&picture, &reading, &self.settings)));
        let shows = self.arguments.html.is_some();
        let shown = shows.then(|| jpeg(&marked(&picture, &reading, &self.settings, side)));
        let rectified = self.arguments.corners.is_some();
        let size = [picture.width(), picture.height()];
        let mut result = ImageResult::new(origin, size, &reading, &self.settings, rectified);
        if let Some(places) = &self.arguments.surface {
            result.state_given_surface(places.0.len());
        }
        result.points = self.arguments.points.then(|| Points::new(&reading));
        Ok(MeasuredPicture {
            result,
            posture: Posture::new(taken, &reading),
            overlay: drawn.transpose()?,
            shown: shown.transpose()?,
        })
    }
}

impl OpenFilm {
    /// Pictures a second, by the file.
    pub(crate) fn rate(&self) -> Option<f64> {
        self.rate
    }

    /// Measures the next pictures; none at the end. Where the film breaks off, what was whole comes first.
    pub(crate) fn next_pictures(
        &mut self,
        ruler: &Ruler<'_>,
    ) -> anyhow::Result<Option<Vec<MeasuredPicture>>> {
        let mut pictures = Vec::new();
        while self.broken.is_none() && pictures.len() < ruler.at_once() {
            let picture = match self.frames.next() {
                Some(Ok(picture)) => picture,
                Some(Err(error)) => {
                    self.broken = Some(error);
                    break;
                }
                None => break,
            };
            let origin = Origin {
                file: self.file.display().to_string(),
                frame: Some(self.next),
                sha256: self.sha256.clone(),
            };
            self.next += ruler.step;
            pictures.push((picture, origin));
        }
        if pictures.is_empty() {
            return self
                .broken
                .take()
                .map_or(Ok(None), |error| Err(error.into()));
        }
        let side = side(usize::MAX);
        let measured = ruler.pool.install(|| {
            let all = pictures.into_par_iter();
            all.map(|(picture, origin)| ruler.measure(picture, origin, side))
                .collect::<anyhow::Result<_>>()
        });
        measured.map(Some)
    }
}

fn png(picture: &image::RgbImage) -> anyhow::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    picture
        .write_with_encoder(PngEncoder::new(&mut bytes))
        .context("cannot draw an overlay")?;
    Ok(bytes)
}
