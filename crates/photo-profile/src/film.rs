//! The pictures of a film, decoded by the program `ffmpeg` one behind the other.

use crate::Error;
use image::codecs::pnm::PnmDecoder;
use image::{DynamicImage, ImageDecoder as _};
use input::file::has_ending;
use std::io::{BufRead as _, BufReader, Read as _};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStderr, ChildStdout, Command, Stdio};
use std::thread::JoinHandle;

/// Name endings of films.
const ENDINGS: [&str; 9] = [
    "mp4", "mov", "m4v", "avi", "mkv", "webm", "mpg", "mpeg", "wmv",
];
/// Bytes of what `ffmpeg` complains about that are kept.
const MOST_TOLD: u64 = 4096;

/// Whether a file is a film by the ending of its name.
pub(crate) fn is_film(path: &Path) -> bool {
    has_ending(path, &ENDINGS)
}

/// A film that is being decoded; dropped, it ends the program.
#[derive(Debug)]
pub(crate) struct Film {
    /// The file.
    path: PathBuf,
    program: Child,
    pictures: BufReader<ChildStdout>,
    /// What it complains about.
    complaints: Option<JoinHandle<String>>,
    /// Pictures so far.
    given: u64,
    /// Whether nothing more comes.
    is_over: bool,
    /// Pictures a second, by the file.
    pub(crate) rate: f64,
}

impl Film {
    /// Starts to decode a film. Its pictures come at the mean rate that the file states; where the file has them unevenly, the
    /// one shown at each moment is taken.
    ///
    /// # Errors
    /// [`Error::Read`] for a file that cannot be read, [`Error::Film`] where the programs are missing or find no film in it.
    pub(crate) fn open(path: &Path) -> Result<Self, Error> {
        drop(input::file::open(path).map_err(|source| Error::Read {
            path: path.to_path_buf(),
            source,
        })?);
        let [over, under] = rate_of(path)?;
        let mut program = start(
            Command::new("ffmpeg")
                .args(["-v", "error", "-nostdin", "-i"])
                .arg(place(path))
                .args([
                    "-map",
                    "0:v:0",
                    "-vf",
                    &format!("fps={over}/{under}"),
                    "-f",
                    "image2pipe",
                    "-c:v",
                    "ppm",
                    "-pix_fmt",
                    "rgb24",
                    "-",
                ]),
            path,
        )?;
        let (Some(pictures), Some(errors)) = (program.stdout.take(), program.stderr.take()) else {
            return Err(failed(path, "ffmpeg has no output"));
        };
        Ok(Self {
            path: path.to_path_buf(),
            program,
            pictures: BufReader::with_capacity(1 << 16, pictures),
            complaints: Some(std::thread::spawn(move || beginning(errors))),
            given: 0,
            is_over: false,
            rate: f64::from(over) / f64::from(under),
        })
    }

    /// The next picture; none at the end.
    fn picture(&mut self) -> Result<Option<DynamicImage>, Error> {
        let read = |source| Error::Read {
            path: self.path.clone(),
            source,
        };
        if self.pictures.fill_buf().map_err(read)?.is_empty() {
            return self.end();
        }
        let damaged = |source| Error::Decode {
            path: self.path.clone(),
            source,
        };
        let decoder = PnmDecoder::new(&mut self.pictures).map_err(damaged)?;
        let (width, height) = decoder.dimensions();
        let pixels = u64::from(width) * u64::from(height);
        if pixels > crate::MOST_PIXELS {
            return Err(Error::TooLarge {
                path: self.path.clone(),
                pixels,
                most: crate::MOST_PIXELS,
            });
        }
        self.given += 1;
        DynamicImage::from_decoder(decoder)
            .map(Some)
            .map_err(damaged)
    }

    /// Hears how the program ended: a film that breaks off is an error, not a shorter film.
    fn end(&mut self) -> Result<Option<DynamicImage>, Error> {
        let status = self.program.wait().map_err(|source| Error::Read {
            path: self.path.clone(),
            source,
        })?;
        let told = self.complaints.take().and_then(|thread| thread.join().ok());
        let complaint = told.as_deref().and_then(|told| told.lines().next());
        if status.success() && complaint.is_none() && self.given > 0 {
            return Ok(None);
        }
        let told = complaint.unwrap_or("no pictures came");
        let what = format!("{told} ({} pictures were whole)", self.given);
        Err(failed(&self.path, &what))
    }
}

impl Iterator for Film {
    type Item = Result<DynamicImage, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.is_over {
            return None;
        }
        let picture = self.picture().transpose();
        self.is_over = !matches!(picture, Some(Ok(_)));
        picture
    }
}

impl Drop for Film {
    /// Ends a program that has more to give; one that has ended already is only laid to rest.
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

/// Pictures a second that a film states, as a fraction.
fn rate_of(path: &Path) -> Result<[u32; 2], Error> {
    let asked = start(
        Command::new("ffprobe")
            .args(["-v", "error", "-select_streams", "v:0"])
            .args(["-show_entries", "stream=avg_frame_rate", "-of", "csv=p=0"])
            .arg(place(path)),
        path,
    )?;
    let output = asked.wait_with_output().map_err(|source| Error::Read {
        path: path.to_path_buf(),
        source,
    })?;
    let told = String::from_utf8_lossy(&output.stdout);
    let rate = told.lines().next().and_then(|line| {
        let (over, under) = line.trim().trim_end_matches(',').split_once('/')?;
        Some([over.parse().ok()?, under.parse().ok()?])
    });
    match rate {
        Some([over, under]) if over > 0 && under > 0 => Ok([over, under]),
        _ => {
            let errors = String::from_utf8_lossy(&output.stderr).into_owned();
            let first = errors
                .lines()
                .next()
                .unwrap_or("no stream of pictures with a rate in it");
            Err(failed(path, first))
        }
    }
}

/// A path that is not a protocol to `ffmpeg`, whatever colons it has.
fn place(path: &Path) -> std::ffi::OsString {
    let mut place = std::ffi::OsString::from("file:");
    place.push(path);
    place
}

/// Starts a program that writes to us.
fn start(command: &mut Command, path: &Path) -> Result<Child, Error> {
    let started = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    started.map_err(|error| {
        let program = command.get_program().to_string_lossy().into_owned();
        failed(
            path,
            &format!(
                "films are decoded by the program {program}, which cannot be started ({error}): install ffmpeg, or give \
                 the pictures themselves"
            ),
        )
    })
}

/// The beginning of what a program complains about; the rest is read and forgotten, so that it never waits for us.
fn beginning(mut errors: ChildStderr) -> String {
    let mut told = Vec::new();
    let _ = errors.by_ref().take(MOST_TOLD).read_to_end(&mut told);
    let _ = std::io::copy(&mut errors, &mut std::io::sink());
    String::from_utf8_lossy(&told).into_owned()
}

/// A film that cannot be decoded.
fn failed(path: &Path, reason: &str) -> Error {
    Error::Film {
        path: path.to_path_buf(),
        reason: reason.to_owned(),
    }
}
