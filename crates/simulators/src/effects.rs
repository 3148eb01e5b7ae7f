//! Physical and camera effects that a model may lack.
//!
//! One effect, one file. An effect is an edit of a scene: it knows its physics, its unit, the
//! amplitude that switches it off and the range that is physically possible. To add one, write
//! its file and name it in [`LIBRARY`].

#![expect(
    clippy::unnecessary_wraps,
    reason = "all edits of a scene have one form, and some can be refused"
)]

mod air_drag;
mod axis_tilt;
mod camera_perspective;
mod camera_roll;
mod cohesion;
mod drive_ripple;
mod drive_slip;
mod dry_adhesion;
mod filling_smoothness;
mod linear_cohesion;
mod liquid_bridges;
mod plate_give;
mod rate_dependent_friction;
mod rig_vibration;
mod rolling_resistance;
mod rolling_spring;
mod seed_count;
mod seed_size;
mod session_drift;
mod shape_mix;
mod shell_wear;
mod size_spread;
mod softened_stiffness;
mod speed_dependent_restitution;
mod wall_charge;
mod wall_friction;
mod walls;
mod whole_seed_damping;

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

/// An effect: its description, and the edit of a scene that switches it on.
///
/// ```
/// let effect = simulators::effects::find("wall-charge")?;
/// assert_eq!(effect.range[0], 0.0);
/// println!("{} in {}: {}", effect.name, effect.unit, effect.physics);
/// # Ok::<(), simulators::effects::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Effect {
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
    /// Edits a scene so that the effect is on with an amplitude other than 0, or says why the scene cannot carry it.
    apply: fn(&mut Scene, f64, &FillingLibrary) -> Result<(), Error>,
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

/// A refusal with its reason, under the name of the effect that led to it.
pub(crate) fn refused(name: &'static str, reason: &dyn std::fmt::Display) -> Error {
    Error::Setting {
        name,
        reason: reason.to_string(),
    }
}

/// All effects. Adding one is adding its file and its line here.
pub static LIBRARY: [Effect; 28] = [
    rolling_resistance::EFFECT,
    rolling_spring::EFFECT,
    whole_seed_damping::EFFECT,
    speed_dependent_restitution::EFFECT,
    rate_dependent_friction::EFFECT,
    cohesion::EFFECT,
    linear_cohesion::EFFECT,
    liquid_bridges::EFFECT,
    dry_adhesion::EFFECT,
    softened_stiffness::EFFECT,
    session_drift::EFFECT,
    filling_smoothness::EFFECT,
    seed_size::EFFECT,
    size_spread::EFFECT,
    shape_mix::EFFECT,
    seed_count::EFFECT,
    air_drag::EFFECT,
    wall_friction::SHELL,
    shell_wear::EFFECT,
    wall_friction::COVER,
    wall_charge::EFFECT,
    plate_give::EFFECT,
    axis_tilt::EFFECT,
    drive_slip::EFFECT,
    drive_ripple::EFFECT,
    rig_vibration::EFFECT,
    camera_roll::EFFECT,
    camera_perspective::EFFECT,
];

/// Names of all effects.
pub fn names() -> Vec<String> {
    LIBRARY.iter().map(|e| e.name.to_owned()).collect()
}

/// The effect of a name.
///
/// # Errors
///
/// A name that is not in the library.
pub fn find(name: &str) -> Result<&'static Effect, Error> {
    let found = LIBRARY.iter().find(|e| e.name == name);
    found.ok_or_else(|| Error::Unknown {
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
    let Effect {
        name,
        unit,
        range: [low, high],
        ..
    } = *effect;
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
        (effect.apply)(scene, amplitude, fillings)?;
        Ok(scene.check()?)
    }
}

#[cfg(test)]
mod tests;
