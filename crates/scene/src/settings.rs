//! What a scene file says.

use crate::steady::{LEAST_KEPT, LEAST_START_UP, expected_swing};
use crate::{Apparatus, MaterialSettings, SeedSettings, SurroundingsSettings};
use contact_law::hard_contact;
use input::quantity::{Angle, Frequency, FrictionCoefficient, Length, Restitution, Time};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// An apparatus with seeds, ready to be run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// The machine that moves the seeds.
    pub apparatus: Apparatus,
    /// Kinds of seeds.
    pub seed: Vec<SeedSettings>,
    /// Walls from meshes, beside those of the apparatus.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub wall: Vec<crate::WallSettings>,
    /// Materials by name.
    pub material: BTreeMap<String, MaterialSettings>,
    /// Contacts by the names of the two materials, joined by a hyphen.
    pub contact: BTreeMap<String, ContactSettings>,
    /// How bodies and contacts are modelled.
    #[serde(default)]
    pub model: ModelSettings,
    /// The protocol: phases, times and frames.
    #[serde(default)]
    pub protocol: Protocol,
    /// The camera.
    #[serde(default)]
    pub camera: CameraSettings,
    /// Forces on the seeds besides gravity and contacts; none if omitted.
    #[serde(default, skip_serializing_if = "SurroundingsSettings::is_empty")]
    pub surroundings: SurroundingsSettings,
    /// Folder to which paths in the scene refer.
    #[serde(skip)]
    pub folder: PathBuf,
    /// Name of the file, for messages.
    #[serde(skip)]
    pub file: String,
}

/// Contact parameters of two materials.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactSettings {
    /// Coefficient of restitution.
    pub restitution: Restitution,
    /// Coefficient of static friction.
    pub static_friction: FrictionCoefficient,
    /// Coefficient of rolling friction; 0 if omitted.
    #[serde(default = "no_friction")]
    pub rolling_friction: FrictionCoefficient,
    /// Attraction of a touching pair of spheres beside that of the Bond number, N; 0 if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub attraction_n: Option<f64>,
    /// Cohesion energy density, J/m³: attraction over the area of contact ([`contact_law::linear_cohesion`]); 0 if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cohesion_energy_density_j_m3: Option<f64>,
    /// Share, 0 to 1, of viscoelastic damping, whose restitution falls with the speed; the restitution
    /// stated holds at 1 m/s ([`contact_law::viscoelastic_damping`]). 0 if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub viscoelastic_damping: Option<f64>,
    /// Relative change of the sliding friction at high speed, half of it at 50 mm/s
    /// ([`contact_law::rate_dependent_friction`]). 0 if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction_rate: Option<f64>,
}

/// No friction, for serde.
fn no_friction() -> FrictionCoefficient {
    FrictionCoefficient::new(0.0).expect("0 is a coefficient of friction")
}

/// How bodies and contacts are modelled.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ModelSettings {
    /// Which mass enters the dashpots; `sphere` if omitted, as in the study's agglomerate.
    pub dashpot_mass: dem_solver::DashpotMass,
    /// Share of the damping of the whole seed in the dashpots of its spheres, 0 to 1, with the same share of their pull
    /// ([`dem_solver::Template::with_whole_damping`]); 0 if omitted, and where `dashpot_mass` is not `sphere`.
    #[serde(skip_serializing_if = "is_zero")]
    pub whole_seed_damping: f64,
    /// Treatment of a dashpot that would pull; `clipped` if omitted: it never does.
    pub normal_force_end: contact_law::NormalForceEnd,
    /// Attraction of a touching pair of spheres over the weight of a seed (granular Bond number); 0 where
    /// absent.
    pub bond_number: f64,
    /// Gravity, m/s²; 9.81 if omitted.
    pub gravity_m_s2: f64,
    /// The law of rolling resistance; of constant torque if omitted.
    pub rolling_law: RollingLaw,
    /// From where the lever arm of rolling resistance is taken; from the centre of the seed if omitted.
    pub rolling_lever: contact_law::RollingLever,
    /// Bonds that hold the spheres of a seed together; seeds are rigid if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bonds: Option<crate::BondedSettings>,
    /// Liquid in bridges between seeds and at walls; dry if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub liquid: Option<LiquidSettings>,
}

/// Whether a share is 0, for serde.
#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde hands over a reference"
)]
fn is_zero(share: &f64) -> bool {
    *share == 0.0
}

impl ModelSettings {
    /// A body type with the dashpots of the model.
    pub(crate) fn template(
        &self,
        clump: &geometry::clump::Clump,
        material: usize,
    ) -> dem_solver::Template {
        let template = dem_solver::Template::new(clump, material, self.dashpot_mass);
        match self.dashpot_mass {
            dem_solver::DashpotMass::Sphere => template.with_whole_damping(self.whole_seed_damping),
            _ => template,
        }
    }
}

impl Default for ModelSettings {
    fn default() -> Self {
        Self {
            dashpot_mass: dem_solver::DashpotMass::Sphere,
            whole_seed_damping: 0.0,
            normal_force_end: contact_law::NormalForceEnd::Clipped,
            bond_number: 0.0,
            gravity_m_s2: 9.81,
            rolling_law: RollingLaw::default(),
            rolling_lever: contact_law::RollingLever::default(),
            bonds: None,
            liquid: None,
        }
    }
}

/// How rolling resistance acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RollingLaw {
    /// Type A: a torque of constant size against the relative rotation.
    #[default]
    ConstantTorque,
    /// Type C: an elastic-plastic spring with a dashpot.
    SpringDashpot,
}

/// Liquid on the seeds. Each pair of spheres that has touched has a bridge, up to the gap at which it breaks; the bridges
/// of a seed share its liquid, at most a sixth each.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LiquidSettings {
    /// Volume of liquid over volume of seeds, 0 to 0.2.
    pub content: f64,
    /// Surface tension, N/m.
    pub surface_tension_n_m: f64,
    /// Angle of contact.
    pub contact_angle: Angle,
    /// Viscosity, Pa s; that of water at 20 °C, 0.001, if omitted. 0 leaves the viscous forces out.
    #[serde(default = "water_viscosity")]
    pub viscosity_pa_s: f64,
    /// Height of the roughness, the least gap in the viscous forces; 10 um if omitted, between polished beads and hairy
    /// seeds. Half of it doubles the force against coming apart at the touch and shortens the time step where that counts.
    #[serde(default = "usual_roughness")]
    pub roughness: Length,
}

/// Viscosity of water at 20 °C, Pa s, for serde.
pub(crate) fn water_viscosity() -> f64 {
    1.0e-3
}

/// Roughness of a surface that nobody describes, for serde.
fn usual_roughness() -> Length {
    Length::from_si(1e-5).expect("10 um is a length")
}

impl LiquidSettings {
    /// Liquid with a volume over that of the seeds, a surface tension (N/m) and an angle of contact; its viscosity and the
    /// roughness are those of a scene that does not state them.
    pub fn new(content: f64, surface_tension_n_m: f64, contact_angle: Angle) -> Self {
        Self {
            content,
            surface_tension_n_m,
            contact_angle,
            viscosity_pa_s: water_viscosity(),
            roughness: usual_roughness(),
        }
    }
}

/// The protocol: phases, times and frames.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Protocol {
    /// Time step of the solver, at most what `step_share` allows; chosen by the two shares where
    /// absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_step: Option<Time>,
    /// Time step while the seeds settle or run out, as a share of the duration of a hard contact, see
    /// [`hard_contact::STEP_SHARE`], which stands where it is absent.
    pub step_share: f64,
    /// Time step while the drive runs, likewise; `step_share` if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flow_step_share: Option<f64>,
    /// Why attempts at the run broke off; the time steps that follow from all this are halved once for each. It belongs neither to a scene
    /// file nor to the key of a run.
    #[serde(skip)]
    pub broken_off: Vec<String>,
    /// Seeds a second that appear above the bottom of the apparatus until all are there; all are there from the
    /// start if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub insertion_rate: Option<Frequency>,
    /// Longest time for the seeds to come to rest before the drive starts, behind the last that appears;
    /// 0.8 s if omitted.
    pub settle_limit: Time,
    /// Slope of the surface of the settled bed in a drum, towards the side that rises: the bed settles
    /// under gravity turned by so much, and the drive starts nearer to the steady state. It changes
    /// the length of the start-up, not the state behind it; estimated from friction and speed if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_slope: Option<Angle>,
    /// When in the session the run is made: 0 at its start, 1 at its end. It matters only to effects
    /// that drift.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub session: Option<f64>,
    /// Longest time of rotation, or of waiting for rest after a wall is lifted; 6 s if omitted.
    pub rotation_limit: Time,
    /// Time between frames; 0.2 s if omitted. An error of a mean over frames is that of whole swings, however close they
    /// lie.
    pub frame_interval: Time,
    /// Least number of frames in the steady state; 10 if omitted.
    pub frames: usize,
    /// Least time of rotation that counts as start-up: frames and means begin behind it, or later where the bed is
    /// steady later. It is never less than 1.5 swings of the bed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_up: Option<Time>,
    /// Largest standard error of the mean direction of the centre of mass over time: a drum turns until it is that small,
    /// four swings of the bed at the least. Any if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angle_error: Option<Angle>,
}

impl Default for Protocol {
    fn default() -> Self {
        let seconds = |time| Time::from_si(time).expect("a positive time");
        Self {
            time_step: None,
            step_share: hard_contact::STEP_SHARE,
            flow_step_share: None,
            broken_off: Vec::new(),
            insertion_rate: None,
            settle_limit: seconds(0.8),
            start_slope: None,
            session: None,
            rotation_limit: seconds(6.0),
            frame_interval: seconds(0.2),
            frames: 10,
            start_up: None,
            angle_error: None,
        }
    }
}

/// The camera that faces the end cover.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CameraSettings {
    /// Width and height of a frame, pixels; 480 if omitted.
    pub pixels: u32,
    /// Turn of the camera about its axis, counter-clockwise positive as seen in the picture; 0 if omitted.
    pub roll: Angle,
    /// Distance of the camera from the front cover; without end if omitted (parallel rays).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub distance: Option<Length>,
    /// Time after each frame of a drum at which a second picture is taken, from which the speed of the surface is read; no
    /// second picture if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pair_interval: Option<Time>,
    /// Largest standard error with which the angle may be known from one frame, 0.1 to 30 degrees; 3 degrees if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_angle_error: Option<Angle>,
}

impl Default for CameraSettings {
    fn default() -> Self {
        Self {
            pixels: 480,
            roll: Angle::from_si(0.0).expect("0 is an angle"),
            distance: None,
            pair_interval: None,
            max_angle_error: None,
        }
    }
}

impl Scene {
    /// Total number of seeds.
    pub fn seed_count(&self) -> usize {
        let kinds = self.seed.iter().map(|s| self.count_of(s));
        kinds.fold(0, usize::saturating_add)
    }

    /// Mass of all seeds, kg.
    pub(crate) fn seed_mass(&self) -> f64 {
        let kinds = self.seed.iter();
        let masses = kinds.map(|s| s.mass_kg() * self.count_of(s) as f64);
        masses.sum()
    }

    /// Sets the total number of seeds, keeping the shares of the kinds (largest remainder).
    pub fn set_seed_count(&mut self, total: usize) {
        let before = self.seed_count();
        if before == 0 {
            return;
        }
        let mut counts: Vec<usize> = self.seed.iter().map(|s| self.count_of(s)).collect();
        let mut rests = Vec::new();
        for (k, count) in counts.iter_mut().enumerate() {
            let exact = *count as u128 * total as u128;
            rests.push((exact % before as u128, k));
            *count = usize::try_from(exact / before as u128).unwrap_or(usize::MAX);
        }
        let given: usize = counts.iter().sum();
        rests.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.cmp(&b.1)));
        for &(_, k) in rests.iter().take(total - given) {
            counts[k] += 1;
        }
        for (kind, count) in self.seed.iter_mut().zip(counts) {
            kind.set_count(count);
        }
    }

    /// Simulated time, s, that a drive turns before its run ends, if the bed is steady at once: the least start-up, and four
    /// swings or the frames behind it, at most the limit. Of an apparatus that goes through phases, their stated times are added.
    pub fn expected_rotation(&self) -> f64 {
        let protocol = &self.protocol;
        let plan = self.apparatus.device().plan(self);
        let stated = plan.map_or(0.0, |plan| plan.stated_time());
        let swing = expected_swing(self.apparatus.radius(), self.model.gravity_m_s2);
        let start_up = self.start_up(swing).unwrap_or(0.0);
        let frames = protocol.frames as f64 * protocol.frame_interval.si();
        let kept = frames.max(LEAST_KEPT as f64 * swing);
        stated + (start_up.max(LEAST_START_UP * swing) + kept).min(protocol.rotation_limit.si())
    }

    /// Time of rotation, s, before which nothing is kept of a bed that swings in a time (s): the stated time, or 1.5
    /// swings after the ramp of the drive; `None` without both.
    pub(crate) fn start_up(&self, swing: f64) -> Option<f64> {
        let stated = self.protocol.start_up.map(Time::si);
        let behind_ramp = self
            .apparatus
            .device()
            .ramp()
            .map(|ramp| ramp + LEAST_START_UP * swing);
        stated.into_iter().chain(behind_ramp).reduce(f64::max)
    }

    /// Contact of two materials, in either order of the names.
    pub fn contact_of(&self, a: &str, b: &str) -> Option<&ContactSettings> {
        self.contact
            .get(&format!("{a}-{b}"))
            .or_else(|| self.contact.get(&format!("{b}-{a}")))
    }
}
