//! Physical and camera effects that a model may lack.
//!
//! One effect, one file. An effect is an edit of a scene: it knows its physics, its unit, the
//! amplitude that switches it off and the range that is physically possible. To add one, write
//! its file and name it in [`library`].

mod air_drag;
mod axis_tilt;
mod camera_perspective;
mod camera_roll;
mod cohesion;
mod cover_friction;
mod drive_ripple;
mod drive_slip;
mod dry_adhesion;
mod filling_smoothness;
mod liquid_bridges;
mod rate_dependent_friction;
mod rig_vibration;
mod rolling_resistance;
mod rolling_spring;
mod seed_count;
mod seed_size;
mod session_drift;
mod shape_mix;
mod shell_friction;
mod shell_wear;
mod size_spread;
mod softened_stiffness;
mod speed_dependent_restitution;
mod wall_charge;
mod walls;

use scene::{FillingLibrary, Scene};
use serde::{Deserialize, Serialize};

/// Where an effect enters the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Entry {
    /// The law of a contact.
    Contact,
    /// Number of bodies, or a force on each.
    Body,
    /// A wall.
    Wall,
    /// The motion and stand of the apparatus.
    Drive,
    /// The shape of the seeds.
    SeedShape,
    /// The camera.
    Camera,
}

/// What is fixed about an effect.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Description {
    /// Name in requests and reports.
    pub name: &'static str,
    /// The physics in a few sentences.
    pub physics: &'static str,
    /// The formula as plain text.
    pub formula: &'static str,
    /// Unit of the amplitude.
    pub unit: &'static str,
    /// Key of the source in the bibliography.
    pub source: &'static str,
    /// Least and largest amplitude that is physically possible; 0 switches the effect off.
    pub range: [f64; 2],
    /// Amplitude at which its sensitivity is usually measured.
    pub probe: f64,
    /// Where it enters.
    pub entry: Entry,
}

/// An effect.
pub trait Effect: Sync {
    /// What is fixed about it.
    fn description(&self) -> Description;

    /// Edits the scene so that the effect is on with an amplitude; 0 leaves it as it is.
    ///
    /// # Errors
    ///
    /// A scene that cannot carry the effect.
    fn apply(
        &self,
        scene: &mut Scene,
        amplitude: f64,
        fillings: &FillingLibrary,
    ) -> Result<(), Error>;
}

/// Why an effect cannot be switched on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// No such effect.
    #[error("no effect '{name}' in the library; it holds {known}")]
    Unknown {
        /// The name given.
        name: String,
        /// Names of the effects.
        known: String,
    },
    /// An amplitude outside the physically possible range.
    #[error("amplitude {amplitude} of effect '{name}' lies outside {low} to {high} {unit}")]
    OutOfRange {
        /// Name of the effect.
        name: &'static str,
        /// The amplitude.
        amplitude: f64,
        /// Least amplitude.
        low: f64,
        /// Largest amplitude.
        high: f64,
        /// Unit.
        unit: &'static str,
    },
    /// A setting that the effect leads to is refused.
    #[error("effect '{name}': {reason}")]
    Setting {
        /// Name of the effect.
        name: &'static str,
        /// What is refused.
        reason: String,
    },
    /// The scene refuses.
    #[error(transparent)]
    Scene(#[from] scene::Error),
}

/// The refusal of a quantity, under the name of the effect that led to it.
pub(crate) fn refused(name: &'static str, error: &quantity::Error) -> Error {
    Error::Setting {
        name,
        reason: error.to_string(),
    }
}

/// All effects. Adding one is adding its file and its line here.
pub fn library() -> [&'static dyn Effect; 25] {
    [
        &rolling_resistance::RollingResistance,
        &rolling_spring::RollingSpring,
        &speed_dependent_restitution::SpeedDependentRestitution,
        &rate_dependent_friction::RateDependentFriction,
        &cohesion::Cohesion,
        &liquid_bridges::LiquidBridges,
        &dry_adhesion::DryAdhesion,
        &softened_stiffness::SoftenedStiffness,
        &session_drift::SessionDrift,
        &filling_smoothness::FillingSmoothness,
        &seed_size::SeedSize,
        &size_spread::SizeSpread,
        &shape_mix::ShapeMix,
        &seed_count::SeedCount,
        &air_drag::AirDrag,
        &shell_friction::ShellFriction,
        &shell_wear::ShellWear,
        &cover_friction::CoverFriction,
        &wall_charge::WallCharge,
        &axis_tilt::AxisTilt,
        &drive_slip::DriveSlip,
        &drive_ripple::DriveRipple,
        &rig_vibration::RigVibration,
        &camera_roll::CameraRoll,
        &camera_perspective::CameraPerspective,
    ]
}

/// Names of all effects.
pub fn names() -> Vec<String> {
    let effects = library();
    let name = |e: &&dyn Effect| e.description().name.to_owned();
    // Hidden from the optimiser as in `find`.
    std::hint::black_box(&effects[..])
        .iter()
        .map(name)
        .collect()
}

/// The effect of a name.
///
/// # Errors
///
/// A name that is not in the library.
pub fn find(name: &str) -> Result<&'static dyn Effect, Error> {
    let effects = library();
    // The length is hidden from the optimiser: it would unroll the loops over the known list into code
    // that takes many minutes to compile.
    let effects: &[&'static dyn Effect] = std::hint::black_box(&effects);
    effects
        .iter()
        .copied()
        .find(|e| e.description().name == name)
        .ok_or_else(|| Error::Unknown {
            name: name.to_owned(),
            known: names().join(", "),
        })
}

/// Switches an effect on.
///
/// # Errors
///
/// An unknown effect, an amplitude out of range, a scene that cannot carry it.
pub fn apply(
    scene: &mut Scene,
    name: &str,
    amplitude: f64,
    fillings: &FillingLibrary,
) -> Result<(), Error> {
    let effect = find(name)?;
    let Description {
        name,
        unit,
        range: [low, high],
        ..
    } = effect.description();
    if !(low..=high).contains(&amplitude) {
        return Err(Error::OutOfRange {
            name,
            amplitude,
            low,
            high,
            unit,
        });
    }
    if amplitude == 0.0 {
        Ok(())
    } else {
        effect.apply(scene, amplitude, fillings)?;
        Ok(scene.check()?)
    }
}

#[cfg(test)]
mod tests;
