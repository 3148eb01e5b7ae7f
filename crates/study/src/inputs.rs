//! The files that a study reads, by their SHA-256.

use crate::Error;
use crate::file::StudyFile;
use crate::study::Checked;
use command_line::file_sha256;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// SHA-256 of the study file, its scenes, their meshes and its photos, by path.
pub(crate) fn of(
    path: &Path,
    file: &StudyFile,
    checked: &Checked,
) -> Result<BTreeMap<String, String>, Error> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut files: BTreeSet<PathBuf> = BTreeSet::from([path.to_owned()]);
    files.extend(file.scenes.iter().map(|s| folder.join(&s.file)));
    for scene in checked.scenes.values().chain(checked.models.values()) {
        let meshes = scene.mesh_files();
        files.extend(meshes.iter().map(|mesh| scene.folder.join(mesh)));
    }
    files.extend(checked.photos.iter().flat_map(|p| p.files.clone()));
    let mut inputs = BTreeMap::new();
    for file in files {
        let hash = file_sha256(&file).map_err(|error| Error::Read {
            path: file.clone(),
            source: std::io::Error::other(format!("{error:#}")),
        })?;
        inputs.insert(file.display().to_string(), hash);
    }
    Ok(inputs)
}
