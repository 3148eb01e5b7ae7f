//! A drum so small that a run takes about a second.

use crate::fixture;
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

/// The scene; FIXTURES represents the folder of the meshes.
const TINY: &str = include_str!("tiny.toml");

/// A folder of its own with the scene in it.
pub(crate) struct TinyScene {
    /// The folder, removed at the end.
    folder: TempDir,
}

impl TinyScene {
    /// Writes the scene.
    pub(crate) fn new() -> Self {
        Self::changed("", "")
    }

    /// Writes the scene with one piece of its text replaced.
    pub(crate) fn changed(from: &str, to: &str) -> Self {
        assert!(TINY.contains(from), "'{from}' is not in the scene");
        let meshes = fixture("stl").canonicalize().unwrap();
        let text = TINY
            .replacen(from, to, 1)
            .replace("FIXTURES", meshes.to_str().unwrap());
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("tiny.toml"), text).unwrap();
        Self { folder }
    }

    /// A path in the folder.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Runs `seedloop simulate tiny.toml` with further words in the folder.
    pub(crate) fn simulate(&self, words: &[&str]) -> std::process::Output {
        let words = [&["simulate", "tiny.toml"], words].concat();
        crate::seedloop(self.folder.path(), &words)
    }
}
