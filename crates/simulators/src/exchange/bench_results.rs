//! What the deck of a bench leaves, read as observables by the rules of the runs here.
//!
//! For each phase the deck leaves the spheres (`K-NAME.dump`) and the walls (`K-NAME.txt`). Of plain spheres all observables of the bench
//! are computed but those of torques; of agglomerates, whose turns a dump does not hold, slopes and extents of the heap at the end.
//!
//! A sphere that a dump no longer holds has passed the outlet: the time of its passage is that of a free fall from where the dump before
//! has it.

use crate::exchange::bench_deck::{BenchDeck, stem};
use crate::exchange::drum_deck::{FINER, are_spheres};
use crate::exchange::{BedSphere, Error, Moment, dump};
use nalgebra::{UnitQuaternion, Vector3};
use scene::{
    ForeignRun, Frame, ObservableValues, Passage, Sample, Scene, SeedBody, observe_foreign,
    read_pile,
};
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

/// Columns with the number of a seed, or of a sphere that is one.
const NUMBER: [&str; 2] = ["mol", "id"];

/// Reads the observables of a bench from the folder in which its deck ran; `time_step` is that of the solver here, s.
///
/// # Errors
///
/// A scene whose apparatus has no phases, a folder without the files of the filling, files that are not what a deck leaves.
pub fn read(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    time_step: f64,
    folder: &Path,
) -> Result<Vec<ObservableValues>, Error> {
    let deck = BenchDeck::of(scene, bodies, time_step / FINER, "a deck")?;
    let mut run = ForeignRun {
        frame: empty_frame(),
        samples: Vec::new(),
        passages: Vec::new(),
    };
    let mut last = None;
    for (number, phase) in deck.procedure.plan.phases.iter().enumerate() {
        let stem = stem(number, &phase.name);
        let path = folder.join(format!("{stem}.dump"));
        if number > 0 && !path.exists() {
            break;
        }
        let moments = moments(&path)?;
        if number == 0 {
            check_seeds(&deck, &moments, &path)?;
        }
        let rows = table(&folder.join(format!("{stem}.txt")))?;
        let seen = PhaseSeen {
            deck: &deck,
            number,
            moments: &moments,
        };
        run.samples.extend(seen.samples(&rows));
        run.passages.extend(seen.passages());
        last = moments.into_iter().last();
    }
    let last = last.unwrap_or_default();
    if !are_spheres(bodies) {
        let spheres: Vec<_> = last.spheres.iter().map(|s| s.sphere).collect();
        let largest = spheres.iter().map(|s| s.radius).fold(0.0, f64::max);
        return Ok(read_pile(&scene.apparatus, &spheres, largest));
    }
    run.frame = frame(&deck, &last);
    Ok(observe_foreign(scene, bodies, run)?)
}

/// Refuses the files of another scene: of a bed that is there from the start, the first moment has all seeds.
fn check_seeds(deck: &BenchDeck<'_>, moments: &[Moment], path: &Path) -> Result<(), Error> {
    let bodies = moments.iter().take(1).flat_map(|moment| &moment.spheres);
    let found = bodies
        .map(|sphere| sphere.body)
        .collect::<BTreeSet<_>>()
        .len();
    let stated = deck.scene.seed_count();
    if deck.procedure.inlet.is_some() || found == stated {
        return Ok(());
    }
    Err(Error::OtherKind {
        file: path.display().to_string(),
        what: format!(
            "it begins with {found} seeds and the scene has {stated}: state the settings with which the deck was exported"
        ),
    })
}

/// The moments of a dump.
fn moments(path: &Path) -> Result<Vec<Moment>, Error> {
    let file = path.display().to_string();
    dump::read_by(&NUMBER, &text_of(path)?, &file, 1)
}

fn text_of(path: &Path) -> Result<String, Error> {
    let refused = |source| Error::Read {
        path: path.to_owned(),
        source,
    };
    let bytes = input::file::read(path).map_err(refused)?;
    String::from_utf8(bytes).map_err(|_| Error::OtherKind {
        file: path.display().to_string(),
        what: "the file is not text".into(),
    })
}

/// The table of walls of a phase.
#[derive(Debug, Default)]
struct Table {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Table {
    /// A vector of three columns in a row; `None` without them.
    fn vector(&self, row: &[f64], kind: char, id: &str) -> Option<Vector3<f64>> {
        let column = |axis: char| {
            let name = format!("{kind}{axis}_{id}");
            let place = self.names.iter().position(|n| *n == name)?;
            row.get(place).copied()
        };
        Some(Vector3::new(column('x')?, column('y')?, column('z')?))
    }
}

/// Reads a table with names in its first line.
fn table(path: &Path) -> Result<Table, Error> {
    let text = text_of(path)?;
    let mut lines = text.lines().enumerate();
    let names = lines.next().map_or("", |(_, line)| line);
    let names: Vec<String> = names.split_whitespace().map(str::to_owned).collect();
    let mut rows = Vec::new();
    for (number, line) in lines {
        let cells: Option<Vec<f64>> = line
            .split_whitespace()
            .map(|cell| cell.parse().ok())
            .collect();
        let cells = cells.filter(|cells| cells.len() == names.len());
        rows.push(cells.ok_or_else(|| Error::Positions {
            file: path.display().to_string(),
            line: number + 1,
            what: format!("a row must hold {} numbers", names.len()),
        })?);
    }
    Ok(Table { names, rows })
}

/// A phase as a code left it.
struct PhaseSeen<'a> {
    deck: &'a BenchDeck<'a>,
    number: usize,
    moments: &'a [Moment],
}

impl PhaseSeen<'_> {
    /// Time of a moment since the start of the phase, s.
    fn time(&self, moment: &Moment) -> f64 {
        let first = self.moments.first().and_then(|m| m.step).unwrap_or(0);
        let steps = moment.step.unwrap_or(first).saturating_sub(first);
        steps as f64 * self.deck.time_step
    }

    /// Height of the lower face of the box, m.
    fn outlet(&self) -> f64 {
        self.deck.domain[0].y
    }

    /// Rows of the table as samples, with the bed of the last moment before each.
    fn samples(&self, table: &Table) -> Vec<Sample> {
        let walls = &self.deck.procedure.walls;
        let meshes = self.deck.procedure.analytic..walls.len();
        let mut moments = self.moments.iter().peekable();
        let mut bed = [0.0; 3];
        let mut samples = Vec::new();
        for row in &table.rows {
            let time = row.first().copied().unwrap_or(0.0);
            while let Some(moment) =
                moments.next_if(|m| self.time(m) <= time + 0.5 * self.deck.time_step)
            {
                bed = self.bed(moment);
            }
            let vector = |kind: char, k: usize| {
                table
                    .vector(row, kind, &self.deck.ids[k])
                    .unwrap_or_default()
            };
            samples.push(Sample {
                phase: self.number,
                time,
                forces: (0..walls.len()).map(|k| vector('f', k)).collect(),
                torques: vec![Vector3::repeat(f64::NAN); meshes.len()],
                displacements: meshes.clone().map(|k| vector('d', k)).collect(),
                mass: bed[0],
                centre: bed[1],
                below: bed[2],
            });
        }
        samples
    }

    /// Mass of the bed (kg), height of its centre (m) and mass below y = 0 (kg).
    fn bed(&self, moment: &Moment) -> [f64; 3] {
        let (mut mass, mut height, mut below) = (0.0, 0.0, 0.0);
        for sphere in moment
            .spheres
            .iter()
            .filter(|s| s.sphere.centre.y >= self.outlet())
        {
            let own = mass_of(self.deck, sphere);
            mass += own;
            height += own * sphere.sphere.centre.y;
            if sphere.sphere.centre.y < 0.0 {
                below += own;
            }
        }
        [mass, if mass > 0.0 { height / mass } else { 0.0 }, below]
    }

    /// Spheres that left, each once.
    fn passages(&self) -> Vec<Passage> {
        let is_out = |s: &BedSphere| s.sphere.centre.y < self.outlet();
        let mut all = Vec::new();
        for pair in self.moments.windows(2) {
            let inside = pair[1].spheres.iter().filter(|s| !is_out(s));
            let left: BTreeSet<usize> = inside.map(|s| s.body).collect();
            let (from, to) = (self.time(&pair[0]), self.time(&pair[1]));
            let gone = pair[0]
                .spheres
                .iter()
                .filter(|s| !is_out(s) && !left.contains(&s.body));
            all.extend(gone.map(|sphere| Passage {
                phase: self.number,
                time: (from + self.fall(sphere)).min(to),
                mass: mass_of(self.deck, sphere),
            }));
        }
        all
    }

    /// Time of a free fall to the outlet, s.
    ///
    /// # Formula
    ///
    /// The positive root of `h = u t + g t²/2`, h the height over the outlet and u the speed downwards.
    fn fall(&self, sphere: &BedSphere) -> f64 {
        let gravity = self.deck.scene.model.gravity_m_s2;
        let height = sphere.sphere.centre.y - self.outlet();
        let speed = sphere.velocity.map_or(0.0, |v| -v.y);
        ((speed * speed + 2.0 * gravity * height).max(0.0).sqrt() - speed) / gravity
    }
}

/// Mass of a plain sphere by the kind whose radius is nearest, kg.
fn mass_of(deck: &BenchDeck<'_>, sphere: &BedSphere) -> f64 {
    deck.bodies[kind_of(deck, sphere)].clump.mass()
}

/// Kind of a plain sphere: that of the nearest radius.
fn kind_of(deck: &BenchDeck<'_>, sphere: &BedSphere) -> usize {
    let off = |body: &SeedBody| (body.clump.bounding_radius() - sphere.sphere.radius).abs();
    let kinds = deck.bodies.iter().enumerate();
    let nearest = kinds.min_by(|(_, a), (_, b)| off(a).total_cmp(&off(b)));
    nearest.map_or(0, |(kind, _)| kind)
}

fn empty_frame() -> Frame {
    Frame {
        time: 0.0,
        kind: Vec::new(),
        position: Vec::new(),
        orientation: Vec::new(),
        velocity: Vec::new(),
        spin: Vec::new(),
        walls: Vec::new(),
    }
}

/// Plain spheres as a frame; those that have passed the outlet are left out.
fn frame(deck: &BenchDeck<'_>, moment: &Moment) -> Frame {
    let mut frame = empty_frame();
    let low = deck.domain[0].y;
    for sphere in moment.spheres.iter().filter(|s| s.sphere.centre.y >= low) {
        frame.kind.push(kind_of(deck, sphere));
        frame.position.push(sphere.sphere.centre);
        frame.orientation.push(UnitQuaternion::identity());
        frame.velocity.push(sphere.velocity.unwrap_or_default());
        frame.spin.push(Vector3::zeros());
    }
    frame
}

#[cfg(test)]
mod tests;
