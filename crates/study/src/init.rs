//! Commented studies to start from.

/// A study to start from.
///
/// ```
/// use study::{Starter, Study};
/// let folder = tempfile::tempdir()?;
/// for file in Starter::Heap.files() {
///     std::fs::write(folder.path().join(file.name), file.text)?;
/// }
/// let study = Study::read(&folder.path().join("study.toml"), None)?;
/// assert!(!study.problem.parameters.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Starter {
    /// A rotating drum.
    Drum,
    /// A heap from a cylinder that is lifted.
    Heap,
    /// A box whose gate is lifted.
    Box,
}

/// A file of a study to start from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StarterFile {
    /// Name.
    pub name: &'static str,
    /// Content.
    pub text: &'static str,
}

impl Starter {
    /// The study, its scene, and the job script of a cluster.
    pub const fn files(self) -> [StarterFile; 3] {
        let (study, scene, name) = match self {
            Self::Drum => (
                include_str!("init/drum-study.toml"),
                include_str!("init/drum.toml"),
                "drum.toml",
            ),
            Self::Heap => (
                include_str!("init/heap-study.toml"),
                include_str!("init/heap.toml"),
                "heap.toml",
            ),
            Self::Box => (
                include_str!("init/box-study.toml"),
                include_str!("init/box.toml"),
                "box.toml",
            ),
        };
        [
            StarterFile {
                name: "study.toml",
                text: study,
            },
            StarterFile { name, text: scene },
            StarterFile {
                name: "cluster.sh",
                text: include_str!("init/cluster.sh"),
            },
        ]
    }
}
