//! Commented studies to start from.

/// A study to start from; all are in [`STARTERS`].
///
/// ```
/// use study::{STARTERS, Study};
/// let folder = tempfile::tempdir()?;
/// let heap = STARTERS.iter().find(|starter| starter.name == "heap").ok_or("no heap")?;
/// for file in heap.files() {
///     std::fs::write(folder.path().join(file.name), file.text)?;
/// }
/// let study = Study::read(&folder.path().join("study.toml"), None)?;
/// assert!(!study.problem.parameters.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Starter {
    /// Name: the kind of its apparatus, or `benches`.
    pub name: &'static str,
    /// What is measured in, in words.
    pub about: &'static str,
    /// Text of the study.
    study: Text,
    /// Name of the scene, without its extension, and its text.
    scene: [&'static str; 2],
}

/// Text of a study.
#[derive(Debug, Clone, Copy)]
enum Text {
    /// As it is.
    Whole(&'static str),
    /// Of one bench: its parameter, and measurements with example values.
    OfBench([&'static str; 2]),
}

/// A file of a study to start from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StarterFile {
    /// Name.
    pub name: String,
    /// Content.
    pub text: String,
}

/// A file of the benches.
macro_rules! of_benches {
    ($name:literal) => {
        include_str!(concat!("../../../fixtures/benches/", $name, ".toml"))
    };
}

const FRICTION_OF_BEADS: &str = r#"[[parameter]]
symbol = "F"
name = "static friction glass-glass"
sets = ["contact.glass-glass.static_friction"]
low = 0.1
high = 0.7"#;

const FRICTION_OF_PEAS: &str = r#"[[parameter]]
symbol = "F"
name = "static friction pea-pea"
sets = ["contact.pea-pea.static_friction"]
low = 0.1
high = 0.7"#;

const STIFFNESS_OF_PEAS: &str = r#"[[parameter]]
symbol = "G"
name = "shear modulus of a pea"
sets = ["material.pea.shear_modulus"]
unit = "MPa"
low = 2.0
high = 8.0"#;

/// A study of one bench, with its measurements from a file.
macro_rules! bench {
    ($name:literal, $about:literal, $parameter:expr) => {
        Starter {
            name: $name,
            about: $about,
            study: Text::OfBench([
                $parameter,
                include_str!(concat!("init/", $name, "-measured.toml")),
            ]),
            scene: [$name, of_benches!($name)],
        }
    };
}

/// A study and a scene of their own.
macro_rules! whole {
    ($name:literal, $about:literal) => {
        Starter {
            name: $name,
            about: $about,
            study: Text::Whole(include_str!(concat!("init/", $name, "-study.toml"))),
            scene: [$name, include_str!(concat!("init/", $name, ".toml"))],
        }
    };
}

/// All studies to start from.
pub const STARTERS: &[Starter] = &[
    whole!("drum", "A rotating drum, angles at two speeds"),
    whole!("heap", "A heap from a cylinder that is lifted"),
    whole!("box", "A box whose gate is lifted"),
    bench!(
        "hopper",
        "A hopper that is emptied through its opening",
        FRICTION_OF_BEADS
    ),
    bench!(
        "draw-down",
        "A box whose seeds fall through a slot on a second floor",
        FRICTION_OF_PEAS
    ),
    bench!("poured-heap", "A heap that is poured", FRICTION_OF_PEAS),
    bench!(
        "ledge",
        "A plate over whose ends a bed is discharged",
        FRICTION_OF_PEAS
    ),
    bench!(
        "bulk-density",
        "A cup that is filled, struck off and tapped",
        FRICTION_OF_BEADS
    ),
    bench!("compression", "A bed under a piston", STIFFNESS_OF_PEAS),
    bench!("direct-shear", "A shear box", FRICTION_OF_PEAS),
    bench!(
        "penetration",
        "A probe pressed into a bed",
        FRICTION_OF_BEADS
    ),
    bench!(
        "machine",
        "A rig of your own: walls, phases and probes",
        FRICTION_OF_PEAS
    ),
    Starter {
        name: "benches",
        about: "Several benches with the same seeds, with the question what to measure next",
        study: Text::Whole(of_benches!("study")),
        scene: ["drum", of_benches!("drum")],
    },
];

impl Starter {
    /// The study, its scene, and the job script of a cluster.
    pub fn files(&self) -> [StarterFile; 3] {
        let file = |name: &str, text: &str| StarterFile {
            name: name.to_owned(),
            text: text.to_owned(),
        };
        let [kind, scene] = self.scene;
        let study = match self.study {
            Text::Whole(text) => text.to_owned(),
            Text::OfBench([parameter, measured]) => include_str!("init/bench-study.toml")
                .replace("KIND", kind)
                .replace("PARAMETER", parameter)
                .replace("MEASURED", &measured.replace("KIND", kind)),
        };
        [
            file("study.toml", &study),
            file(&format!("{kind}.toml"), scene),
            file("cluster.sh", include_str!("init/cluster.sh")),
        ]
    }
}
