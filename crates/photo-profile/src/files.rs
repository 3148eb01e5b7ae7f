//! Which picture files are meant.

use crate::Error;
use crate::overlay::is_overlay;
use input::file::is_hidden;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

/// Name endings of pictures that are taken from a folder.
const ENDINGS: [&str; 8] = ["png", "jpg", "jpeg", "bmp", "gif", "tif", "tiff", "webp"];
/// Names of left-out files that are listed of each kind; the others are counted.
const NAMED: usize = 3;

/// The pictures among files and folders, and the files that were left out.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PictureFiles {
    /// Pictures to read; those of a folder in the order of their names, numbers in them by their value.
    pub files: Vec<PathBuf>,
    /// Files that are not photos.
    pub left_out: Vec<LeftOut>,
}

/// A file that is not a photo.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftOut {
    /// The file.
    pub file: PathBuf,
    /// Why it is left out.
    pub why: NoPhoto,
}

/// Why a file is not a photo.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoPhoto {
    /// A picture that this crate drew over a photo, see [`crate::overlay`]: the photo itself would count twice.
    Overlay,
    /// The mask of the photos.
    Mask,
    /// A file of a folder whose name begins with a dot: what an operating system or a program keeps beside a photo under
    /// the name of that photo (`._photo.jpg`).
    Hidden,
    /// A file of a folder whose name has not the ending of a picture.
    Ending,
}

impl NoPhoto {
    /// All reasons, in the order in which they are reported.
    const ALL: [Self; 4] = [Self::Overlay, Self::Mask, Self::Hidden, Self::Ending];

    /// What so many files are, in words.
    fn words(self, n: usize) -> String {
        let files = if n == 1 { "file" } else { "files" };
        match self {
            Self::Overlay if n == 1 => "1 overlay of this program".to_owned(),
            Self::Overlay => format!("{n} overlays of this program"),
            Self::Mask => "the mask".to_owned(),
            Self::Hidden => format!("{n} hidden {files}"),
            Self::Ending => format!("{n} {files} without the ending of a picture"),
        }
    }
}

impl PictureFiles {
    /// Looks for the pictures in folders; a file that is named represents itself, unless it is an overlay or the mask.
    ///
    /// # Errors
    /// [`Error::Read`] for a folder that cannot be listed, [`Error::NoPicture`] for one without photos, and
    /// [`Error::OnlyOverlays`] if nothing but overlays is named.
    pub fn find(photos: &[PathBuf], mask: Option<&Path>) -> Result<Self, Error> {
        let mask = mask.and_then(|mask| mask.canonicalize().ok());
        let is_mask = |file: &Path| mask.is_some() && file.canonicalize().ok() == mask;
        let mut found = Self::default();
        for photo in photos {
            let (named, others) = if photo.is_dir() {
                files_in(photo)?
            } else {
                (vec![photo.clone()], Vec::new())
            };
            let before = (found.files.len(), found.left_out.len());
            for file in named {
                let why = if is_mask(&file) {
                    Some(NoPhoto::Mask)
                } else {
                    is_overlay(&file).then_some(NoPhoto::Overlay)
                };
                match why {
                    Some(why) => found.left_out.push(LeftOut { file, why }),
                    None => found.files.push(file),
                }
            }
            let others = others.into_iter().map(|file| LeftOut {
                why: if is_hidden(&file) {
                    NoPhoto::Hidden
                } else {
                    NoPhoto::Ending
                },
                file,
            });
            found.left_out.extend(others);
            if photo.is_dir() && found.files.len() == before.0 {
                return Err(Error::NoPicture {
                    folder: photo.clone(),
                    endings: ENDINGS.join(", "),
                    left_out: remark(&found.left_out[before.1..])
                        .map_or(String::new(), |r| format!("; {r}")),
                });
            }
        }
        if let (true, Some(first)) = (found.files.is_empty(), found.left_out.first()) {
            return Err(Error::OnlyOverlays {
                path: first.file.clone(),
            });
        }
        Ok(found)
    }

    /// Message about what was left out; `None` if nothing was.
    pub fn remark(&self) -> Option<String> {
        remark(&self.left_out)
    }
}

/// Files that were left out, in words; none if there are none.
fn remark(left_out: &[LeftOut]) -> Option<String> {
    let kinds = NoPhoto::ALL.into_iter().filter_map(|why| {
        let files = left_out.iter().filter(|left| left.why == why);
        let names: Vec<String> = files.map(LeftOut::name).collect();
        let more = if names.len() > NAMED { ", ..." } else { "" };
        let listed = names[..names.len().min(NAMED)].join(", ");
        (!names.is_empty()).then(|| format!("{} ({listed}{more})", why.words(names.len())))
    });
    let kinds: Vec<String> = kinds.collect();
    (!kinds.is_empty()).then(|| format!("left out, as no photos: {}", kinds.join("; ")))
}

impl LeftOut {
    /// The name of the file without its folder.
    fn name(&self) -> String {
        let name = self.file.file_name().unwrap_or(self.file.as_os_str());
        name.to_string_lossy().into_owned()
    }
}

/// The files in a folder that are pictures by the ending of their names, and the others, in the order of their names.
fn files_in(folder: &Path) -> Result<(Vec<PathBuf>, Vec<PathBuf>), Error> {
    input::file::files_in(folder, &ENDINGS).map_err(|source| Error::Read {
        path: folder.to_path_buf(),
        source,
    })
}

/// One of so many pictures: of several files each `every`-th file, and all pictures in it; of one file all of it. Also the number that
/// states which pictures of a file to take, 1 for all.
pub fn one_of(every: NonZeroUsize, files: Vec<PathBuf>) -> (Vec<PathBuf>, usize) {
    if files.len() > 1 {
        (files.into_iter().step_by(every.get()).collect(), 1)
    } else {
        (files, every.get())
    }
}
