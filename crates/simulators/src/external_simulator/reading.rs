//! Positions that another code left of a scene, read by the rules and the ruler here.

use crate::exchange::Moment;
use crate::external_simulator::bed::{Bed, Drive, Took};
use crate::external_simulator::error::Error;
use crate::scene_simulator::over_frames;
use campaign::SimulatorError;
use campaign::run_store::Observation;
use input::quantity::Time;
use scene::{DrumCamera, Scene, SteadyRule, read_pile};
use std::collections::BTreeMap;

/// Observables of a scene from moments of another code, in the axes of CONVENTIONS.md. Moments without spheres at the start, before
/// any was put in, are left out; a drum without a measurable surface has no angle.
///
/// A drum was turning from the first moment on, and its moments are `interval` (s) apart; of a heap or a box the last moment
/// counts, at which it is at rest.
///
/// # Errors
///
/// No moment, a moment without spheres behind one with some, a drum whose bed is not steady, another apparatus.
pub fn read_scene(
    scene: &Scene,
    mut moments: Vec<Moment>,
    interval: f64,
) -> Result<BTreeMap<String, Observation>, Error> {
    let refused = |problem: &str| Error::Setting {
        what: format!("positions of {}", scene.file),
        problem: problem.to_owned(),
    };
    let first = moments.iter().position(|m| !m.spheres.is_empty());
    moments.drain(..first.unwrap_or(0));
    if moments.iter().any(|m| m.spheres.is_empty()) {
        return Err(refused("a moment holds no sphere"));
    }
    let last = moments
        .last()
        .ok_or_else(|| refused("there is no moment"))?;
    if scene.apparatus.has_phases() {
        let spheres: Vec<_> = last.spheres.iter().map(|s| s.sphere).collect();
        let largest = spheres.iter().map(|s| s.radius).fold(0.0, f64::max);
        let read = read_pile(&scene.apparatus, &spheres, largest);
        let told = read.iter().filter_map(|found| {
            let value = over_frames(&found.values, found.unit)?;
            Some((found.name.to_string(), value))
        });
        return Ok(told.collect());
    }
    if scene.apparatus.speed() == 0.0 {
        return Err(refused(
            "positions are read of a turning drum, a heap or a box",
        ));
    }
    if !(interval > 0.0 && interval.is_finite()) {
        return Err(refused("the interval of moments must be above 0 s"));
    }
    let mut bed = Bed::new(Drive {
        camera: DrumCamera::of(scene),
        spin: scene.apparatus.speed(),
        gravity: scene.model.gravity_m_s2,
        interval,
    });
    for moment in moments {
        bed.push(moment);
    }
    let protocol = &scene.protocol;
    let rule = SteadyRule::for_bed(
        bed.swing(),
        protocol.start_up.map(Time::si),
        bed.len() as f64 * interval,
        interval,
        protocol.angle_error.map(|e| e.si().to_degrees()),
    );
    let state = bed.judge(&rule);
    if let Some(doubt) = state.doubt {
        return Err(refused(&format!(
            "the bed is not steady: {}",
            doubt.words()
        )));
    }
    let outcome = bed.outcome(state, 1, Took::default(), Vec::new());
    let outcome = outcome.map_err(|error: SimulatorError| refused(&error.in_full()))?;
    Ok(outcome.observables)
}

#[cfg(test)]
mod tests {
    use super::read_scene;
    use crate::exchange::{Moment, dump};
    use scene::Scene;
    use std::path::Path;

    /// A scene of spheres of 2 mm in an apparatus.
    fn scene(apparatus: &str) -> Scene {
        let text = format!(
            r#"
            apparatus = {apparatus}
            seed = [{{ name = "bead", sphere = "2 mm", density = "1500 kg/m3", count = 9, material = "bead" }}]
            material.bead = {{ poisson_ratio = 0.25, shear_modulus = "1 MPa" }}
            material.wall = {{ poisson_ratio = 0.25, shear_modulus = "1 MPa" }}
            contact.bead-bead = {{ restitution = 0.5, static_friction = 0.3 }}
            contact.bead-wall = {{ restitution = 0.5, static_friction = 0.4 }}
            "#
        );
        Scene::from_text(&text, "scene.toml", Path::new(""), &[]).unwrap()
    }

    /// A box with its gate.
    fn a_box() -> Scene {
        scene(
            r#"{ kind = "box-collapse", length = "24 mm", height = "90 mm", width = "16 mm", lift_speed = "1 m/s",
                floor = "wall", wall = "wall" }"#,
        )
    }

    /// A drum that turns counter-clockwise.
    fn a_drum() -> Scene {
        scene(
            r#"{ kind = "drum", inner_diameter = "60 mm", width = "16 mm", speed = "20 rpm", shell = "wall",
                cover = "wall" }"#,
        )
    }

    /// Spheres of 2 mm whose centres are inside, as a dump gives them.
    fn moment(is_inside: impl Fn(f64, f64) -> bool) -> Moment {
        let places = (-60..=60_i32).flat_map(|i| (-60..=60_i32).map(move |j| (i, j)));
        let places = places.map(|(i, j)| (f64::from(i) * 0.5e-3, f64::from(j) * 0.5e-3));
        let rows: Vec<String> = places
            .filter(|(x, y)| is_inside(*x, *y))
            .map(|(x, y)| format!("{x} {y} 0 0.001\n"))
            .collect();
        let head = "ITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\nITEM: ATOMS x y z radius";
        let text = format!(
            "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n{}\n{head}\n{}",
            rows.len(),
            rows.concat()
        );
        dump::read(&text, "bed.dump", 1).unwrap().remove(0)
    }

    /// A wedge of 30 degrees, 17 mm high, that another code left in the box: a degree is the roughness of spheres of a
    /// seventeenth of the height. The moments before the last, of a flat bed, do not count.
    #[test]
    fn the_slope_in_a_box_is_that_of_the_last_moment() {
        let slope = 30_f64.to_radians().tan();
        let flat = moment(|x, y| (0.0..0.03).contains(&x) && (0.0..0.005).contains(&y));
        let wedge = moment(|x, y| x >= 0.0 && y >= 0.0 && y < 0.016 - slope * x);
        let read = read_scene(&a_box(), vec![flat, wedge], 0.05).unwrap();
        let angle = read["angle_of_repose_deg"].mean;
        assert!((angle - 30.0).abs() < 1.0, "{angle} deg");
        let height = read["height_mm"].mean;
        assert!((height - 17.0).abs() < 0.6, "{height} mm: a row is 0.5 mm");
    }

    /// A bed that lies at 31 degrees in all moments is steady and reads 31 degrees: half a degree is the roughness of rows 0.5 mm
    /// apart over a bed of 50 mm. One that turns on is not, and is refused with the reason.
    #[test]
    fn a_steady_bed_is_read_and_another_is_refused() {
        let bed = |degrees: f64| {
            let slope = degrees.to_radians().tan();
            moment(move |x, y| y < slope * x - 0.005 && x.hypot(y) < 0.029)
        };
        let lies = (0..60).map(|_| bed(31.0)).collect();
        let read = read_scene(&a_drum(), lies, 0.05).unwrap();
        let angle = read["angle_deg"].mean;
        assert!((angle - 31.0).abs() < 0.5, "{angle} deg");
        let turns = (0..60).map(|k| bed(f64::from(k))).collect();
        let error = read_scene(&a_drum(), turns, 0.05).unwrap_err().to_string();
        assert!(
            error.contains("scene.toml") && error.contains("not steady"),
            "{error}"
        );
    }

    #[test]
    fn what_cannot_be_read_is_refused() {
        let told = |scene: &Scene, moments: Vec<Moment>, interval: f64| {
            read_scene(scene, moments, interval)
                .unwrap_err()
                .to_string()
        };
        let some = || moment(|x, y| y < 0.0 && x.hypot(y) < 0.029);
        assert!(told(&a_drum(), vec![], 0.05).contains("no moment"));
        assert!(told(&a_box(), vec![Moment::default()], 0.05).contains("no sphere"));
        assert!(told(&a_drum(), vec![some()], f64::NAN).contains("interval"));
    }
}
