//! Errors between scenes and the calibration.

use std::path::PathBuf;

/// Why there is no simulator, no outcome, or no parameter file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A mesh of a scene cannot be read.
    #[error(
        "{file}: mesh '{}' cannot be read ({source}): give its path from the folder of this file",
        mesh.display()
    )]
    Mesh {
        /// The scene file.
        file: String,
        /// The mesh, as the scene writes it.
        mesh: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// No scene has the setting of a parameter.
    #[error(
        "parameter '{symbol}' sets '{path}', which none of the scenes has ({files}): write the dotted path of a \
         setting, such as contact.seed-seed.static_friction"
    )]
    NoSetting {
        /// Symbol of the parameter.
        symbol: String,
        /// The dotted path.
        path: String,
        /// Files of the scenes.
        files: String,
    },
    /// The setting of a parameter does not accept a number.
    #[error("parameter '{symbol}': {source}")]
    Setting {
        /// Symbol of the parameter.
        symbol: String,
        /// What the scene says.
        source: Box<scene::Error>,
    },
    /// The details of a record are not those of a run of a scene.
    #[error("record {key} does not hold the details of a run of a scene ({source}): run it again")]
    Details {
        /// Key of the record.
        key: String,
        /// What is missing or wrong.
        source: serde_json::Error,
    },
    /// The details of a run have no form in JSON.
    #[error("the details of the run cannot be kept")]
    Unwritable(#[source] serde_json::Error),
    /// A parameter file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A text is not a parameter file.
    #[error("{file}: {message}")]
    Text {
        /// The file.
        file: String,
        /// Line, fault and expected text.
        message: String,
    },
    /// A parameter of a file is invalid.
    #[error("{file}: parameter '{symbol}' {problem}")]
    Parameter {
        /// The file.
        file: String,
        /// Symbol of the parameter.
        symbol: String,
        /// Its fault, and the remedy.
        problem: String,
    },
    /// A scene has none of the settings of a parameter file.
    #[error(
        "{file}: {scene} has none of its settings ({paths}): give the scene that they were calibrated for, or one \
         with the same names of materials"
    )]
    NothingToSet {
        /// The parameter file.
        file: String,
        /// The scene file.
        scene: String,
        /// The dotted paths.
        paths: String,
    },
    /// A parameter file cannot be written.
    #[error("the parameters have no form in TOML: {0}")]
    NoToml(#[from] toml::ser::Error),
    /// A scene is refused, or its run gives nothing.
    #[error(transparent)]
    Scene(#[from] scene::Error),
}
