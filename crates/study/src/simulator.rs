//! Scenes and effects as a simulator that the calibration can ask.

use campaign::{RunOutcome, RunRequest, Simulator, SimulatorError};
use image::{DynamicImage, ImageFormat};
use photo_profile::Verdict;
use quantity::AngularSpeed;
use run_store::Observation;
use scene::{Apparatus, FillingLibrary, Override, RunResult, Scene, drum_picture, run};
use std::collections::{BTreeMap, VecDeque};
use std::io::Cursor;
use std::sync::{Arc, Mutex};
use std::time::Instant;
use surface_profile::{SeriesSummary, summarise};

/// Revision of the physics: raised when the same scene and seed give other or further numbers.
const REVISION: u32 = 6;

/// Runs whose frames are kept in memory: some megabytes each for a thousand seeds.
const REMEMBERED: usize = 256;

/// Scenes by name, with effects that can be switched on.
///
/// A request's `parameters` are settings of the scene by their dotted path; its `condition` may
/// hold `rpm`, `seed_count` and `session`; its `effects` are those of [`effect_library`].
#[derive(Debug)]
pub struct SceneSimulator {
    /// Scenes by the name that requests use.
    scenes: BTreeMap<String, Scene>,
    /// Bodies made so far.
    fillings: FillingLibrary,
    /// Version of code, scenes and meshes.
    version: String,
    /// The last runs by what moved the seeds: a scene without its camera, and the seed.
    moved: Mutex<VecDeque<(String, Arc<RunResult>)>>,
}

impl SceneSimulator {
    /// Makes a simulator of named scenes.
    ///
    /// # Errors
    ///
    /// A mesh that cannot be read: its bytes are part of the version.
    pub fn new(scenes: BTreeMap<String, Scene>) -> Result<Self, crate::Error> {
        let mut meshes: BTreeMap<String, Vec<u8>> = BTreeMap::new();
        for (name, scene) in &scenes {
            for mesh in scene.mesh_files() {
                let written = mesh.display().to_string();
                let bytes = std::fs::read(scene.folder.join(mesh)).map_err(|source| {
                    crate::Error::Meaning {
                        file: scene.file.clone(),
                        what: format!("mesh '{written}'"),
                        problem: format!(
                            "cannot be read ({source}): give its path from the folder of this file"
                        ),
                    }
                })?;
                // Scenes of different folders may write the same path and mean different meshes.
                let other = meshes.get(&written).is_some_and(|known| *known != bytes);
                let key = if other {
                    format!("{written} of {name}")
                } else {
                    written
                };
                meshes.insert(key, bytes);
            }
        }
        let content = serde_json::json!({ "scenes": scenes, "meshes": meshes });
        let key = run_store::run_key("scenes", &content, 0)?;
        let version = format!(
            "seedloop {} physics {REVISION} scenes {}",
            env!("CARGO_PKG_VERSION"),
            &key[..16]
        );
        Ok(Self {
            scenes,
            fillings: FillingLibrary::default(),
            version,
            moved: Mutex::default(),
        })
    }

    /// Bodies made so far.
    pub fn fillings(&self) -> &FillingLibrary {
        &self.fillings
    }

    /// Runs a scene; where the same seeds moved before under another camera, their frames are seen again.
    ///
    /// Returns the run, and whether it was only seen.
    fn run_or_see(
        &self,
        scene: &Scene,
        seed: u64,
    ) -> Result<(Arc<RunResult>, bool), SimulatorError> {
        let mut blind = serde_json::to_value(scene).map_err(SimulatorError::other)?;
        if let Some(settings) = blind.as_object_mut() {
            settings.remove("camera");
        }
        let key = format!("{seed} {} {blind}", scene.folder.display());
        let known = self.moved.lock().ok().and_then(|mut moved| {
            let at = moved.iter().position(|(other, _)| *other == key)?;
            // What was asked for again stays longest.
            let entry = moved.remove(at)?;
            let result = Arc::clone(&entry.1);
            moved.push_back(entry);
            Some(result)
        });
        if let Some(result) = known {
            let seen = result.seen_in(scene).map_err(SimulatorError::other)?;
            return Ok((Arc::new(seen), true));
        }
        let result = run(scene, &self.fillings, seed).map_err(SimulatorError::other)?;
        let result = Arc::new(result);
        if let Ok(mut moved) = self.moved.lock() {
            moved.push_back((key, Arc::clone(&result)));
            if moved.len() > REMEMBERED {
                moved.pop_front();
            }
        }
        Ok((result, false))
    }

    /// The scene that a request stands for.
    ///
    /// # Errors
    ///
    /// A model, parameter, condition or effect that cannot be meant.
    pub fn scene_of(&self, request: &RunRequest) -> Result<Scene, SimulatorError> {
        let refused = |reason: String| SimulatorError::Refused { reason };
        let base = self.scenes.get(&request.model).ok_or_else(|| {
            let known: Vec<_> = self.scenes.keys().map(String::as_str).collect();
            refused(format!(
                "no model '{}'; there are {}",
                request.model,
                known.join(", ")
            ))
        })?;
        let overrides: Vec<Override> = request
            .parameters
            .iter()
            .map(|(name, value)| Override {
                name: name.clone(),
                value: value.to_string(),
            })
            .collect();
        let mut scene = base.with(&overrides).map_err(SimulatorError::other)?;
        for (name, value) in &request.condition {
            match name.as_str() {
                "rpm" => {
                    let speed = AngularSpeed::from_si(value * std::f64::consts::TAU / 60.0);
                    scene
                        .apparatus
                        .set_speed(speed.map_err(SimulatorError::other)?);
                }
                "seed_count" if *value >= 1.0 && value.fract() == 0.0 && *value < 1e7 => {
                    #[expect(
                        clippy::cast_possible_truncation,
                        clippy::cast_sign_loss,
                        reason = "checked by the guard"
                    )]
                    scene.set_seed_count(*value as usize);
                }
                "session" if (0.0..=1.0).contains(value) => {
                    scene.protocol.session = Some(*value);
                }
                _ => {
                    return Err(refused(format!(
                        "condition '{name}' = {value}; known are rpm, seed_count (a whole number, \
                         1 or more) and session (0 at its start, 1 at its end)"
                    )));
                }
            }
        }
        for (name, amplitude) in &request.effects {
            effect_library::apply(&mut scene, name, *amplitude, &self.fillings)
                .map_err(SimulatorError::other)?;
        }
        Ok(scene)
    }
}

impl Simulator for SceneSimulator {
    fn version(&self) -> String {
        self.version.clone()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        let scene = self.scene_of(request)?;
        let begin = Instant::now();
        let (result, only_seen) = self.run_or_see(&scene, request.seed)?;
        let mut outcome = outcome_of(&scene, &result, begin.elapsed().as_secs_f64())
            .map_err(SimulatorError::other)?;
        if only_seen {
            // The time is that of the pictures alone.
            outcome.details["timing"]["only_seen"] = true.into();
        }
        Ok(outcome)
    }

    fn expected_cost(&self, request: &RunRequest) -> f64 {
        self.scene_of(request).map_or(1.0, |scene| {
            let start_up = 1.0 + scene.protocol.settle_limit.si();
            let frames = scene.protocol.frames as f64 * scene.protocol.frame_interval.si();
            scene.seed_count() as f64 * (start_up + frames) / scene.protocol.step_share
        })
    }
}

/// A mean over frames as an observation.
fn over_frames(values: &[f64], unit: &str) -> Option<Observation> {
    let SeriesSummary { mean, sd, n, .. } = summarise(values).ok()?;
    let sd = (n > 1).then_some(sd);
    Some(Observation {
        mean,
        sd,
        n,
        unit: unit.into(),
    })
}

/// The outcome of a run: observables with their units, and details for the reader.
///
/// # Errors
///
/// A drum in which no frame could be measured, a frame that cannot be drawn.
pub fn outcome_of(
    scene: &Scene,
    result: &RunResult,
    wall_s: f64,
) -> Result<RunOutcome, scene::Error> {
    let mut outcome = RunOutcome::default();
    let mut add = |name: &str, observation: Option<Observation>| {
        if let Some(observation) = observation {
            outcome.observables.insert(name.into(), observation);
        }
    };
    let photos = result.readings.iter().map(|r| r.photo.angle);
    let image: Vec<f64> = photos
        .clone()
        .flatten()
        .map(|a| a.line.to_degrees())
        .collect();
    let curvature: Vec<f64> = photos.clone().flatten().map(|a| a.curvature).collect();
    let s_shape: Vec<f64> = photos.flatten().map(|a| a.s_shape).collect();
    let (mut position, mut difference) = (Vec::new(), Vec::new());
    for reading in &result.readings {
        let by_position = reading.position.map(|a| a.line.to_degrees());
        position.extend(by_position);
        let by_image = reading.photo.angle.map(|a| a.line.to_degrees());
        difference.extend(by_image.zip(by_position).map(|(i, p)| i - p));
    }
    if matches!(scene.apparatus, Apparatus::Drum(_)) && image.is_empty() {
        let first = result.readings.first().map(|r| match &r.photo.verdict {
            Verdict::Refused { reason } => reason.to_string(),
            Verdict::Ok => String::new(),
        });
        return Err(scene::Error::NoSurface {
            frames: result.frames.len(),
            reason: first.unwrap_or_default(),
        });
    }
    let filling: Vec<f64> = result
        .filling_angles
        .iter()
        .map(|a| a.to_degrees())
        .collect();
    let start = result.truncation.map_or(0, |t| t.cut);
    let steady = &result.series[start.min(result.series.len())..];
    let mass: Vec<f64> = steady.iter().map(|p| p.centre_of_mass_deg).collect();
    let slip: Vec<f64> = steady.iter().map(|p| p.shell_slip).collect();
    let kinetic: Vec<f64> = steady.iter().map(|p| p.kinetic_energy_j * 1e3).collect();
    let fluctuation = summarise(&mass).ok().map(|s| Observation {
        mean: s.sd,
        sd: None,
        n: 1,
        unit: "deg".into(),
    });
    add("angle_deg", over_frames(&image, "deg"));
    add("angle_by_position_deg", over_frames(&position, "deg"));
    add("image_minus_position_deg", over_frames(&difference, "deg"));
    add("curvature", over_frames(&curvature, "1"));
    add("s_shape", over_frames(&s_shape, "1"));
    add("filling_angle_deg", over_frames(&filling, "deg"));
    add("centre_of_mass_deg", over_frames(&mass, "deg"));
    add("fluctuation_deg", fluctuation);
    add("shell_slip", over_frames(&slip, "1"));
    add("kinetic_energy_mj", over_frames(&kinetic, "mJ"));
    for further in &result.further {
        add(further.name, over_frames(&further.values, further.unit));
    }

    outcome.details = details(scene, result, wall_s, &image, &position)?;
    Ok(outcome)
}

/// What is worth keeping of a run besides the observables.
fn details(
    scene: &Scene,
    result: &RunResult,
    wall_s: f64,
    image: &[f64],
    position: &[f64],
) -> Result<serde_json::Value, scene::Error> {
    let picture = match result.frames.last() {
        // The camera of the scene looks into a drum.
        Some(_) if scene.apparatus.is_release() => None,
        Some(frame) => Some(png(&DynamicImage::from(drum_picture(
            scene,
            &result.bodies,
            frame,
        )?))),
        None => None,
    };
    let filling: Vec<f64> = result
        .filling_angles
        .iter()
        .map(|a| a.to_degrees())
        .collect();
    let cut = result
        .truncation
        .map_or(0, |t| t.cut)
        .min(result.series.len());
    let start_up = result.series.get(cut).map(|p| p.time_s);
    let lag = summarise(image).ok();
    Ok(serde_json::json!({
        "regime": result.regime,
        "steady": result.truncation.is_some_and(|t| t.steady),
        "start_up_s": start_up,
        "froude_number": scene.apparatus.froude_number(scene.model.gravity_m_s2),
        "frames": {
            "times_s": result.frames.iter().map(|f| f.time).collect::<Vec<_>>(),
            "angles_deg": image,
            "angles_by_position_deg": position,
            "filling_angles_deg": filling,
            "refused": result.readings.iter().filter(|r| r.photo.angle.is_none()).count(),
            "effective_number": lag.map(|s| s.n_effective),
        },
        "series": {
            "time_s": result.series.iter().map(|p| p.time_s).collect::<Vec<_>>(),
            "centre_of_mass_deg": result.series.iter().map(|p| p.centre_of_mass_deg).collect::<Vec<_>>(),
        },
        "timing": {
            "time_step_s": result.time_step,
            "settling_time_step_s": result.settling_time_step,
            "steps": result.n_steps,
            "wall_s": wall_s,
            "us_per_step": wall_s * 1e6 / result.n_steps.max(1) as f64,
            "bodies": result.n_bodies,
            "spheres": result.n_spheres,
            "sphere_steps_per_s": result.n_spheres as f64 * result.n_steps as f64 / wall_s.max(1e-9),
        },
        "last_frame_png_base64": picture,
    }))
}

/// A picture as PNG in base 64.
fn png(picture: &DynamicImage) -> String {
    use base64::Engine as _;
    let mut bytes = Cursor::new(Vec::new());
    // Writing to memory fails for no picture that exists; an empty string would show in the report.
    if picture.write_to(&mut bytes, ImageFormat::Png).is_err() {
        return String::new();
    }
    base64::engine::general_purpose::STANDARD.encode(bytes.into_inner())
}

#[cfg(test)]
mod tests {
    use super::SceneSimulator;
    use campaign::{RunRequest, Simulator as _};
    use scene::{Override, Scene};
    use std::collections::BTreeMap;
    use std::path::Path;

    /// Two scenes write the same path and mean meshes of their own folders: the version, and with it every key of
    /// a run, follows the bytes of both. A mesh that is not there is told with the file that names it.
    #[test]
    fn the_version_follows_every_mesh() {
        let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/cotton");
        let folder = tempfile::tempdir().unwrap();
        let mut scene = Scene::read(&fixtures.join("drum.toml"), &[]).unwrap();
        let meshes: Vec<_> = scene.mesh_files().into_iter().map(Into::into).collect();
        let write = |of: &str, text: &str| {
            for mesh in &meshes {
                let path = folder.path().join(of).join::<&std::path::PathBuf>(mesh);
                std::fs::create_dir_all(path.parent().unwrap()).unwrap();
                std::fs::write(path, text).unwrap();
            }
        };
        let mut of = |name: &str| {
            scene.folder = folder.path().join(name).join("scenes");
            scene.clone()
        };
        let scenes = BTreeMap::from([("a".to_owned(), of("a")), ("b".to_owned(), of("b"))]);
        let refused = SceneSimulator::new(scenes.clone()).unwrap_err().to_string();
        let told = "drum.toml: mesh '../stl/cotton_ellipsoidal.stl' cannot be read";
        assert!(refused.contains(told), "{refused}");
        let mut versions = std::collections::BTreeSet::new();
        for (a, b) in [("one", "one"), ("two", "one"), ("one", "two")] {
            write("a/scenes", a);
            write("b/scenes", b);
            let simulator = SceneSimulator::new(scenes.clone()).unwrap();
            versions.insert(simulator.version());
        }
        assert_eq!(versions.len(), 3, "{versions:?}");
    }

    /// Another camera sees the seeds of the run before: the same observables as a simulator that moves them
    /// anew, to the last bit, and another angle than the camera before.
    #[test]
    fn another_camera_sees_the_same_motion() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/cotton/drum.toml");
        let changes = [
            ("apparatus.inner_diameter", "70 mm"),
            ("apparatus.width", "14 mm"),
            ("seed.0.count", "50"),
            ("seed.1.count", "6"),
            ("seed.0.filling.sphere_radius", "0.8 mm"),
            ("seed.0.filling.sphere_count", "20"),
            ("seed.1.filling.sphere_radius", "0.8 mm"),
            ("seed.1.filling.sphere_count", "16"),
            ("protocol.frames", "3"),
            ("time_s", "0.8"),
        ]
        .map(|(name, value)| Override {
            name: name.into(),
            value: value.into(),
        });
        let scene = Scene::read(&file, &changes).unwrap();
        let fresh =
            || SceneSimulator::new(BTreeMap::from([("drum".into(), scene.clone())])).unwrap();
        let straight = RunRequest::new("drum", 3);
        let turned = straight.clone().with_effect("camera-roll", 3.0);
        let simulator = fresh();
        let first = simulator.run(&straight).unwrap();
        let seen = simulator.run(&turned).unwrap();
        let moved = fresh().run(&turned).unwrap();
        assert_eq!(seen.observables, moved.observables);
        assert_ne!(
            seen.observables["angle_deg"],
            first.observables["angle_deg"]
        );
        assert_eq!(seen.details["timing"]["only_seen"], true);
        assert!(
            moved.details["timing"].get("only_seen").is_none(),
            "moved anew"
        );
        let other_seed = simulator.run(&turned.with_seed(4)).unwrap();
        assert!(
            other_seed.details["timing"].get("only_seen").is_none(),
            "other seeds"
        );
    }
}
