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
    /// A hopper.
    Hopper,
    /// A draw-down box.
    DrawDown,
    /// A poured heap.
    PouredHeap,
    /// A plate over whose ends a bed is discharged.
    Ledge,
    /// A cup that is filled, struck off and tapped.
    BulkDensity,
    /// A bed under a piston.
    Compression,
    /// A shear box.
    DirectShear,
    /// A probe pressed into a bed.
    Penetration,
    /// Several benches with the same seeds.
    Benches,
}

/// A file of a study to start from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StarterFile {
    /// Name.
    pub name: String,
    /// Content.
    pub text: String,
}

/// The parameter, and the measurements with example values, of a study of one bench.
struct Bench {
    /// Name of the apparatus.
    kind: &'static str,
    scene: &'static str,
    parameter: &'static str,
    measured: &'static str,
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

impl Starter {
    /// The study, its scene, and the job script of a cluster.
    pub fn files(self) -> [StarterFile; 3] {
        let file = |name: &str, text: &str| StarterFile {
            name: name.to_owned(),
            text: text.to_owned(),
        };
        let [study, scene] = match self {
            Self::Drum => [
                file("study.toml", include_str!("init/drum-study.toml")),
                file("drum.toml", include_str!("init/drum.toml")),
            ],
            Self::Heap => [
                file("study.toml", include_str!("init/heap-study.toml")),
                file("heap.toml", include_str!("init/heap.toml")),
            ],
            Self::Box => [
                file("study.toml", include_str!("init/box-study.toml")),
                file("box.toml", include_str!("init/box.toml")),
            ],
            Self::Benches => [
                file("study.toml", of_benches!("study")),
                file("drum.toml", of_benches!("drum")),
            ],
            _ => {
                let bench = self.bench();
                let study = include_str!("init/bench-study.toml")
                    .replace("KIND", bench.kind)
                    .replace("PARAMETER", bench.parameter)
                    .replace("MEASURED", &bench.measured.replace("KIND", bench.kind));
                let name = format!("{}.toml", bench.kind);
                [file("study.toml", &study), file(&name, bench.scene)]
            }
        };
        [
            study,
            scene,
            file("cluster.sh", include_str!("init/cluster.sh")),
        ]
    }

    /// What differs between the studies of one bench.
    fn bench(self) -> Bench {
        match self {
            Self::DrawDown => Bench {
                kind: "draw-down",
                scene: of_benches!("draw-down"),
                parameter: FRICTION_OF_PEAS,
                measured: include_str!("init/draw-down-measured.toml"),
            },
            Self::PouredHeap => Bench {
                kind: "poured-heap",
                scene: of_benches!("poured-heap"),
                parameter: FRICTION_OF_PEAS,
                measured: include_str!("init/poured-heap-measured.toml"),
            },
            Self::Ledge => Bench {
                kind: "ledge",
                scene: of_benches!("ledge"),
                parameter: FRICTION_OF_PEAS,
                measured: include_str!("init/ledge-measured.toml"),
            },
            Self::BulkDensity => Bench {
                kind: "bulk-density",
                scene: of_benches!("bulk-density"),
                parameter: FRICTION_OF_BEADS,
                measured: include_str!("init/bulk-density-measured.toml"),
            },
            Self::Compression => Bench {
                kind: "compression",
                scene: of_benches!("compression"),
                parameter: STIFFNESS_OF_PEAS,
                measured: include_str!("init/compression-measured.toml"),
            },
            Self::DirectShear => Bench {
                kind: "direct-shear",
                scene: of_benches!("direct-shear"),
                parameter: FRICTION_OF_PEAS,
                measured: include_str!("init/direct-shear-measured.toml"),
            },
            Self::Penetration => Bench {
                kind: "penetration",
                scene: of_benches!("penetration"),
                parameter: FRICTION_OF_BEADS,
                measured: include_str!("init/penetration-measured.toml"),
            },
            // The others have files of their own.
            _ => Bench {
                kind: "hopper",
                scene: of_benches!("hopper"),
                parameter: FRICTION_OF_BEADS,
                measured: include_str!("init/hopper-measured.toml"),
            },
        }
    }
}
