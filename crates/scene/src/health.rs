//! What a run must keep to.

use crate::{Apparatus, Scene, SeedBody};
use contact_law::hard_contact;
use dem_solver::HealthLimits;
use nalgebra::Vector3;
use std::sync::Arc;

/// Largest overlap over the radius of the smaller sphere. The laws hold for small overlaps; a hard
/// contact of the study's seeds reaches about a tenth.
const OVERLAP: f64 = 0.5;

/// Limits for a scene: the seeds stay in the apparatus, and none is faster than a fall across it and
/// the walls together would make it, five times over.
pub(crate) fn limits(scene: &Scene, bodies: &[Arc<SeedBody>]) -> HealthLimits {
    let [low, high] = scene.apparatus.device().room();
    let (size, gravity) = ((high - low).norm(), scene.model.gravity_m_s2);
    let fall = (2.0 * gravity * size.max(fall_height(scene))).sqrt();
    let length = bodies
        .iter()
        .map(|b| b.clump.bounding_radius())
        .fold(0.0, f64::max);
    // On an open floor seeds may roll away; a drum or a device must hold them.
    let open = if scene.apparatus.has_phases() {
        100.0 * size
    } else {
        length
    };
    HealthLimits {
        low: low - Vector3::repeat(open),
        high: high + Vector3::repeat(open),
        speed: 5.0 * (fall + rim_speed(scene) + mesh_speed(scene)),
        overlap: OVERLAP,
    }
}

/// Speed of the walls that the apparatus turns, m/s.
fn rim_speed(scene: &Scene) -> f64 {
    scene.apparatus.speed().abs() * scene.apparatus.radius()
}

/// Greatest speed of the walls of meshes within the apparatus, m/s.
fn mesh_speed(scene: &Scene) -> f64 {
    let [low, high] = scene.apparatus.device().room();
    let meshes = scene.wall.iter();
    let speeds = meshes.map(|w| w.fastest((high - low).norm()));
    speeds.fold(scene.apparatus.device().fastest_wall(), f64::max)
}

/// Height of a fall across the apparatus, or from where seeds appear to the floor y = 0 if that is lower, m.
pub(crate) fn fall_height(scene: &Scene) -> f64 {
    let [low, high] = scene.apparatus.device().room();
    high.y - low.y.min(0.0)
}

/// Speed of a hard meeting of two seeds, or of a seed and a wall, m/s: at least [`hard_contact::SPEED`].
///
/// # Formula
///
/// `(sqrt(2 g h) + v_rim) / 2 + v_mesh`: half of a fall across the apparatus and of the speed at its rim, for the rule of the time step
/// was found in drums of 60 to 140 mm, in which twice [`hard_contact::SPEED`] is just not reached; and all of the speed of a
/// mesh, which hits a seed that does not give way. In a drop h is its height. (docs/time-step.md)
pub(crate) fn impact_speed(scene: &Scene) -> f64 {
    let height = match &scene.apparatus {
        Apparatus::Drop(test) => test.height.si(),
        _ => fall_height(scene),
    };
    let fall = (2.0 * scene.model.gravity_m_s2 * height).sqrt();
    (0.5 * (fall + rim_speed(scene)) + mesh_speed(scene)).max(hard_contact::SPEED)
}

#[cfg(test)]
mod tests {
    use super::impact_speed;
    use crate::{Override, Scene};
    use contact_law::hard_contact;
    use dev_support::fixture_files::fixture;

    /// The speed in a scene of the study with changes, m/s.
    fn speed(file: &str, changes: &[(&str, &str)]) -> f64 {
        let changes: Vec<_> = changes
            .iter()
            .map(|(name, value)| Override {
                name: (*name).into(),
                value: (*value).into(),
            })
            .collect();
        impact_speed(&Scene::read(&fixture(file), &changes).expect("a scene"))
    }

    /// The apparatus of the study, in which the rule was found, take the least speed to the last bit; so their steps do not change.
    #[test]
    fn small_apparatus_have_the_least_speed() {
        for file in ["drum", "measured", "metering", "heap", "box"] {
            assert_eq!(
                speed(&format!("cotton/{file}.toml"), &[]),
                hard_contact::SPEED,
                "{file}"
            );
        }
    }

    /// Half of a fall across 0.8 m and of the rim at 10 rpm: (3.962 + 0.419) / 2 m/s; a cylinder 2 m high: 6.264 / 2 m/s; a fast plate
    /// of a metering device: half of 2.0 m/s at the rim of 0.1 m at 191 rpm more. Rounding of the digits.
    #[test]
    fn the_speed_follows_from_fall_and_walls() {
        let drum = "cotton/drum.toml";
        let large = speed(
            drum,
            &[("apparatus.inner_diameter", "800 mm"), ("rpm", "10")],
        );
        assert!((large - 2.190).abs() < 1e-3, "{large}");
        let high = speed("cotton/heap.toml", &[("apparatus.height", "2 m")]);
        assert!((high - 3.132).abs() < 1e-3, "{high}");
        let device = [("apparatus.inner_diameter", "200 mm"), ("rpm", "191")];
        let fast = speed("cotton/metering.toml", &device);
        assert!((fast - (0.5 * (1.981 + 2.0))).abs() < 1e-3, "{fast}");
    }
}
