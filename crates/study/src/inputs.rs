//! The files that a study reads, by their SHA-256.

use crate::Error;
use crate::file::StudyFile;
use crate::photos::PhotoSeries;
use command_line::file_sha256;
use scene::Scene;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// SHA-256 of the study file, its scenes, their meshes, its photos, curves and its template, by path from the folder of the study file: the same
/// however the path of the study was typed.
pub(crate) fn of<'s>(
    path: &Path,
    file: &StudyFile,
    scenes: impl Iterator<Item = &'s Scene>,
    photos: &[PhotoSeries],
    curves: impl Iterator<Item = PathBuf>,
) -> Result<BTreeMap<String, String>, Error> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut files: BTreeSet<PathBuf> = BTreeSet::from([path.to_owned()]);
    let of_scenes = file.scene.iter().filter_map(|s| s.file.as_ref());
    files.extend(of_scenes.map(|file| folder.join(file)));
    for scene in scenes {
        let meshes = scene.shape_files();
        files.extend(meshes.iter().map(|mesh| scene.folder.join(mesh)));
    }
    files.extend(curves);
    for series in photos {
        files.extend(series.files.iter().chain(&series.mask).cloned());
    }
    if let Some(template) = &file.simulator.template {
        files.extend(files_in(&folder.join(template))?);
    }
    let mut inputs = BTreeMap::new();
    for file in files {
        let hash = file_sha256(&file).map_err(|error| Error::Read {
            path: file.clone(),
            source: std::io::Error::other(format!("{error:#}")),
        })?;
        let name = file.strip_prefix(folder).unwrap_or(&file);
        inputs.insert(name.display().to_string(), hash);
    }
    Ok(inputs)
}

fn files_in(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let told = |source| Error::Read {
        path: folder.to_owned(),
        source,
    };
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(told)? {
        let path = entry.map_err(told)?.path();
        if path.is_dir() {
            files.extend(files_in(&path)?);
        } else {
            files.push(path);
        }
    }
    Ok(files)
}
