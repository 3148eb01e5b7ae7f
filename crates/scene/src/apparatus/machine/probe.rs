//! Probes of a machine: what is read from the samples of a phase, or from the seeds at the end.

use super::{Machine, check_box, point, unit};
use crate::Error;
use crate::apparatus::hopper::steady_flow;
use crate::check::bad;
use crate::outline::{FLANK, Outline, View};
use crate::phases::{Sample, Seen};
use geometry::clump::{Sphere, volume_of_sphere};
use input::quantity::Length;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// A number that the machine gives.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Probe {
    /// Name of the observable, which ends with its unit: `lid_force_n`.
    pub name: String,
    /// What is read.
    pub reads: Reading,
    /// Phase in which it is read; the last if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub phase: Option<String>,
    /// Which of the values of the phase; their mean if omitted.
    #[serde(default, skip_serializing_if = "Part::is_mean")]
    pub value: Part,
    /// Fraction of the duration of the phase from which on values count; 0 if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<f64>,
    /// Fraction of the duration of the phase up to which values count; 1 if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<f64>,
}

/// Which of the values of a phase.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Part {
    /// Their mean.
    #[default]
    Mean,
    /// The greatest.
    Greatest,
    /// The least.
    Least,
    /// The last.
    Last,
    /// The last less the first.
    Change,
}

impl Part {
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
    fn is_mean(&self) -> bool {
        *self == Self::Mean
    }

    /// The value of values in order of time; `None` without any.
    fn of(self, values: &[f64]) -> Option<f64> {
        let (first, last) = (values.first()?, values.last()?);
        Some(match self {
            Self::Mean => values.iter().sum::<f64>() / values.len() as f64,
            Self::Greatest => values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            Self::Least => values.iter().copied().fold(f64::INFINITY, f64::min),
            Self::Last => *last,
            Self::Change => last - first,
        })
    }
}

/// What a probe reads.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Reading {
    /// Force of the bed on walls along a direction, N.
    Force {
        /// Names of the walls, whose forces are added.
        walls: Vec<String>,
        /// Direction.
        along: [f64; 3],
    },
    /// Torque of the bed on a wall about its own point, along a direction, N mm.
    Torque {
        /// Name of the wall.
        wall: String,
        /// Direction.
        along: [f64; 3],
    },
    /// Displacement of a wall along a direction since the start, mm.
    Displacement {
        /// Name of the wall.
        wall: String,
        /// Direction.
        along: [f64; 3],
    },
    /// Mass of the bed in the machine, g.
    Mass {},
    /// Mass flow through the outlets of the phase while its discharge is steady, g/s.
    MassFlow {},
    /// Mass that the outlets of the phase take out, g.
    Discharged {},
    /// Height of the centre of mass of the bed, mm.
    CentreHeight {},
    /// Volume of the seeds over that of a region, at the end of the run; a sphere counts if its centre is in the region.
    SolidFraction {
        /// Lower and upper corner.
        region: [[Length; 3]; 2],
    },
    /// Slopes of a heap on a level floor, at the end of the run, deg: both flanks as seen along z, from 0.2 to 0.8 of its height.
    HeapAngle {
        /// Height of the floor.
        floor: Length,
    },
}

impl Reading {
    /// Unit, and the end of the name of an observable with it.
    fn unit(&self) -> [&'static str; 2] {
        match self {
            Self::Force { .. } => ["N", "_n"],
            Self::Torque { .. } => ["N mm", "_n_mm"],
            Self::Displacement { .. } | Self::CentreHeight {} => ["mm", "_mm"],
            Self::Mass {} | Self::Discharged {} => ["g", "_g"],
            Self::MassFlow {} => ["g/s", "_g_s"],
            Self::SolidFraction { .. } => ["1", ""],
            Self::HeapAngle { .. } => ["deg", "_deg"],
        }
    }

    /// Whether it is read once, from the seeds at the end of the run or from the whole phase.
    fn is_single(&self) -> bool {
        matches!(
            self,
            Self::MassFlow {}
                | Self::Discharged {}
                | Self::SolidFraction { .. }
                | Self::HeapAngle { .. }
        )
    }

    /// Direction that it states.
    fn along(&self) -> Option<[f64; 3]> {
        match self {
            Self::Force { along, .. }
            | Self::Torque { along, .. }
            | Self::Displacement { along, .. } => Some(*along),
            _ => None,
        }
    }
}

impl Probe {
    /// Unit of its values.
    pub(super) fn unit(&self) -> &'static str {
        self.reads.unit()[0]
    }

    /// Names of the walls at which it looks.
    pub(super) fn walls(&self) -> Vec<&str> {
        match &self.reads {
            Reading::Force { walls, .. } => walls.iter().map(String::as_str).collect(),
            Reading::Torque { wall, .. } | Reading::Displacement { wall, .. } => vec![wall],
            _ => Vec::new(),
        }
    }

    /// Part of the phase that counts.
    fn window(&self) -> [f64; 2] {
        [self.from.unwrap_or(0.0), self.to.unwrap_or(1.0)]
    }

    /// Refuses a name that is not a word with the unit at its end.
    fn check_name(&self) -> Result<(), Error> {
        let [_, end] = self.reads.unit();
        let is_of_word = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
        let is_word = self.name.chars().all(is_of_word);
        if is_word && self.name.len() > end.len() && self.name.ends_with(end) {
            return Ok(());
        }
        let requirement =
            format!("small letters, digits and '_', with the unit at the end: ..{end}");
        let value = format!("{:?}", self.name);
        Err(bad("apparatus.probe.name", value, &requirement))
    }

    /// Refuses a probe that cannot give a value.
    pub(super) fn check(&self, machine: &Machine) -> Result<(), Error> {
        let name = |key: &str| format!("apparatus.probe '{}': {key}", self.name);
        self.check_name()?;
        if let Some(along) = self.reads.along() {
            unit(&name("along"), along)?;
        }
        let of_mesh = matches!(
            self.reads,
            Reading::Torque { .. } | Reading::Displacement { .. }
        );
        if let Some(plane) = self.walls().into_iter().find(|w| machine.is_plane(w))
            && of_mesh
        {
            let requirement = "another shape, such as a rectangle: a plane does not move, and has no point to turn about";
            return Err(bad(&name("wall"), format!("'{plane}'"), requirement));
        }
        if let Reading::SolidFraction { region } = &self.reads {
            check_box(&name("region"), region)?;
        }
        let phase = match &self.phase {
            None => machine.phase.last(),
            Some(phase) => machine.phase.iter().find(|p| p.name == *phase),
        };
        let Some(phase) = phase else {
            let known: Vec<_> = machine.phase.iter().map(|p| p.name.as_str()).collect();
            let requirement = format!("one of {}", known.join(", "));
            let value = self.phase.clone().unwrap_or_default();
            return Err(bad(&name("phase"), value, &requirement));
        };
        let flows = matches!(self.reads, Reading::MassFlow {} | Reading::Discharged {});
        if flows && phase.outlet.is_empty() {
            let requirement = "a phase with an outlet";
            return Err(bad(&name("phase"), phase.name.clone(), requirement));
        }
        let [from, to] = self.window();
        if !(from >= 0.0 && from < to && to <= 1.0) {
            let requirement = "fractions of the phase, 0 <= from < to <= 1";
            return Err(bad(
                &name("from and to"),
                format!("{from} and {to}"),
                requirement,
            ));
        }
        let has_part = self.value != Part::Mean || self.from.is_some() || self.to.is_some();
        if self.reads.is_single() && has_part {
            let requirement = "absent: this reading gives one value";
            return Err(bad(
                &name("value, from and to"),
                "stated".into(),
                requirement,
            ));
        }
        Ok(())
    }

    /// Its value in a run, and both slopes of a heap; none if the run did not come so far.
    pub(super) fn value(&self, seen: &Seen<'_>) -> Vec<f64> {
        let last = seen.last_phase().to_owned();
        let phase = self.phase.as_deref().unwrap_or(&last);
        let passages = || seen.passages(phase);
        let single = match &self.reads {
            Reading::MassFlow {} => steady_flow(&passages()).map(|flow| 1e3 * flow),
            Reading::Discharged {} => Some(1e3 * passages().iter().map(|p| p[1]).sum::<f64>()),
            Reading::SolidFraction { region } => Some(solid_fraction(&seen.spheres(), region)),
            Reading::HeapAngle { floor } => return heap_angles(seen, floor.si()),
            _ => self.of_samples(seen, phase),
        };
        single.into_iter().collect()
    }

    /// The value of those of the samples of a phase within the window.
    fn of_samples(&self, seen: &Seen<'_>, phase: &str) -> Option<f64> {
        let samples = seen.samples(phase);
        let duration = samples.last()?.time;
        let [from, to] = self.window().map(|fraction| fraction * duration);
        let counts = |sample: &&&Sample| sample.time >= from && sample.time <= to;
        let counted = samples.iter().filter(counts);
        let values: Option<Vec<f64>> = counted.map(|s| self.of_sample(seen, s)).collect();
        self.value.of(&values?)
    }

    /// The value of a sample; `None` of a reading that is not a series.
    fn of_sample(&self, seen: &Seen<'_>, sample: &Sample) -> Option<f64> {
        let part =
            |vector: Vector3<f64>, along: [f64; 3]| vector.dot(&Vector3::from(along).normalize());
        Some(match &self.reads {
            Reading::Force { walls, along } => {
                let walls: Vec<&str> = walls.iter().map(String::as_str).collect();
                part(seen.force(sample, &walls), *along)
            }
            Reading::Torque { wall, along } => 1e3 * part(seen.torque(sample, wall), *along),
            Reading::Displacement { wall, along } => {
                1e3 * part(seen.displacement(sample, wall), *along)
            }
            Reading::Mass {} => 1e3 * sample.mass,
            Reading::CentreHeight {} => 1e3 * sample.centre,
            _ => return None,
        })
    }
}

/// Volume of the spheres whose centres are in a region, over its volume.
fn solid_fraction(spheres: &[Sphere], region: &[[Length; 3]; 2]) -> f64 {
    let [low, high] = region.each_ref().map(point);
    let inside = |s: &&Sphere| (0..3).all(|k| s.centre[k] >= low[k] && s.centre[k] <= high[k]);
    let volumes = spheres
        .iter()
        .filter(inside)
        .map(|s| volume_of_sphere(s.radius));
    volumes.sum::<f64>() / (high - low).product()
}

/// Slopes of both flanks of the spheres above a floor (m), deg.
fn heap_angles(seen: &Seen<'_>, floor: f64) -> Vec<f64> {
    let above = seen.spheres().into_iter().filter_map(|s| {
        let centre = s.centre - Vector3::y() * floor;
        (centre.y > 0.0).then_some(Sphere { centre, ..s })
    });
    let above: Vec<Sphere> = above.collect();
    let Some(outline) = Outline::of(&above, View::AlongZ, 0.5 * seen.largest_radius()) else {
        return Vec::new();
    };
    let sides = [outline.mirrored(), outline];
    let flanks = sides.iter().filter_map(|side| side.right_flank(FLANK));
    flanks.map(f64::to_degrees).collect()
}
