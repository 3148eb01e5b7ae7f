//! A folder with a scene and a design table.

use experiment_design::table::{design_to_csv, factors_to_csv};
use experiment_design::{Factor, box_behnken};
use scene::{Override, Scene};
use std::fs;
use study::{DesignChoices, DesignTable, Error};
use tempfile::TempDir;

/// A drum with peas. Beans touch the spare wall only.
const DRUM: &str = r#"
seed = [{ name = "pea", sphere = "6 mm", density = "1300 kg/m3", count = 100, material = "pea" }]

[apparatus]
kind = "drum"
inner_diameter = "100 mm"
width = "20 mm"
speed = "15 rpm"
shell = "wall"
cover = "wall"

[material]
pea = { poisson_ratio = 0.3, shear_modulus = "5 MPa" }
bean = { poisson_ratio = 0.3, shear_modulus = "5 MPa" }
wall = { poisson_ratio = 0.3, shear_modulus = "1 GPa" }
spare = { poisson_ratio = 0.3, shear_modulus = "1 GPa" }

[contact]
pea-pea = { restitution = 0.5, static_friction = 0.35 }
pea-wall = { restitution = 0.5, static_friction = 0.3 }
pea-spare = { restitution = 0.5, static_friction = 0.3 }
bean-bean = { restitution = 0.5, static_friction = 0.3 }
bean-spare = { restitution = 0.5, static_friction = 0.3 }
"#;

/// Path of the friction of peas.
pub(crate) const FRICTION: &str = "contact.pea-pea.static_friction";

/// A folder with the scene and a table.
pub(crate) struct Folder {
    /// Where they are; removed at the end.
    folder: TempDir,
    /// What the table is read with.
    pub(crate) choices: DesignChoices,
}

impl Folder {
    /// Writes both; the first seed is 11.
    pub(crate) fn new(table: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("drum.toml"), DRUM).unwrap();
        fs::write(path("design.csv"), table).unwrap();
        let choices = DesignChoices {
            design: path("design.csv"),
            scene: path("drum.toml"),
            seed: 11,
            ..DesignChoices::default()
        };
        Self { folder, choices }
    }

    /// Says which settings a column sets.
    pub(crate) fn bind(mut self, text: &str) -> Self {
        self.choices.bind.push(text.to_owned());
        self
    }

    /// Keeps a column unused.
    pub(crate) fn keep(mut self, column: &str) -> Self {
        self.choices.keep.push(column.to_owned());
        self
    }

    /// Says how often each row is run.
    pub(crate) fn replicates(mut self, n: usize) -> Self {
        self.choices.replicates = Some(n);
        self
    }

    /// Changes the scene of all runs.
    pub(crate) fn set(mut self, text: &str) -> Self {
        self.choices.set.push(text.to_owned());
        self
    }

    /// Writes the factors.
    pub(crate) fn factors(mut self, factors: &[Factor]) -> Self {
        let file = self.folder.path().join("factors.csv");
        fs::write(&file, factors_to_csv(factors)).unwrap();
        self.choices.factors = Some(file);
        self
    }

    /// Reads the table.
    pub(crate) fn read(&self) -> Result<DesignTable, Error> {
        DesignTable::read(&self.choices)
    }

    /// The scenes of a table that is right, in the order of its runs.
    pub(crate) fn scenes(&self) -> Vec<Scene> {
        let table = self.read().unwrap();
        let simulator = table.simulator().unwrap();
        let requests = table.requests();
        let scenes = requests.iter().map(|request| simulator.scene_of(request));
        scenes.collect::<Result<_, _>>().unwrap()
    }

    /// The scene of the folder with one setting changed.
    pub(crate) fn scene_with(&self, name: &str, value: &str) -> Scene {
        let (name, value) = (name.to_owned(), value.to_owned());
        Scene::read(&self.choices.scene, &[Override { name, value }]).unwrap()
    }

    /// Everything that is wrong with the table, a line each.
    pub(crate) fn problems(&self) -> String {
        match self.read() {
            Err(Error::Problems { list }) => {
                let lines: Vec<String> = list.iter().map(ToString::to_string).collect();
                lines.join("\n")
            }
            // A file that is not a table, in the words that the command prints: an error and its causes.
            Err(Error::Table(error)) => {
                let mut told = error.to_string();
                let mut next = std::error::Error::source(&error);
                while let Some(cause) = next {
                    told = format!("{told}\n{cause}");
                    next = cause.source();
                }
                told
            }
            other => format!("no list of problems: {other:?}"),
        }
    }
}

/// Friction, restitution and speed with their ranges.
pub(crate) fn factors() -> Vec<Factor> {
    vec![
        Factor::new("F", "friction", "1", 0.2, 0.5).unwrap(),
        Factor::new("E", "restitution", "1", 0.3, 0.7).unwrap(),
        Factor::new("W", "speed", "rpm", 10.0, 30.0).unwrap(),
    ]
}

/// A Box-Behnken design of them: 12 runs and 2 of the centre.
pub(crate) fn design() -> String {
    design_to_csv(&box_behnken(&factors(), 2).unwrap())
}

/// The design bound to its settings.
pub(crate) fn bound(table: &str) -> Folder {
    let folder = Folder::new(table).factors(&factors());
    let restitution = "E=contact.pea-pea.restitution,contact.pea-wall.restitution";
    let folder = folder.bind(&format!("F={FRICTION}")).bind(restitution);
    folder.bind("W=apparatus.speed")
}
