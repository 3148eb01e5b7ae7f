//! A bed of another code, read by the rules and the ruler that read the beds here.

use crate::exchange::Moment;
use crate::scene_simulator::{
    FrameDetails, NOT_STEADY, RunDetails, SeriesDetails, SurfaceReadings, TimingDetails,
    effective_number, error_over_swings, no_surface, over_frames, png_in_base64, scatter_of, word,
};
use campaign::run_store::Observation;
use campaign::{RunOutcome, SimulatorError};
use scene::{
    BedMotion, DrumCamera, FrameReading, MotionEvidence, SeriesPoint, SteadyRule, SteadyState,
    swing_time,
};
use std::collections::BTreeMap;

/// The drum in which a bed turns, and how its moments follow each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Drive {
    /// The drum and the camera that sees it.
    pub(crate) camera: DrumCamera,
    /// Speed of the drum, counter-clockwise positive, rad/s.
    pub(crate) spin: f64,
    /// Gravity, m/s².
    pub(crate) gravity: f64,
    /// Time between two moments, s.
    pub(crate) interval: f64,
}

/// A bed over time.
#[derive(Debug, Clone)]
pub(crate) struct Bed {
    /// The drum.
    drive: Drive,
    /// One value a moment.
    series: Vec<SeriesPoint>,
    moments: Vec<Moment>,
}

/// What the run took.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Took {
    /// Wall time, s.
    pub(crate) wall_s: f64,
    /// Time step, s.
    pub(crate) time_step: f64,
    /// Number of steps.
    pub(crate) steps: u64,
    /// Number of seeds.
    pub(crate) bodies: usize,
    /// Threads or ranks.
    pub(crate) threads: usize,
}

impl Bed {
    /// A bed that was not seen yet.
    pub(crate) fn new(drive: Drive) -> Self {
        Self {
            drive,
            series: Vec::new(),
            moments: Vec::new(),
        }
    }

    /// Adds the next moment; its time counts from the start of the drive.
    pub(crate) fn push(&mut self, moment: Moment) {
        let Drive {
            camera,
            spin,
            interval,
            ..
        } = self.drive;
        let spun = moment.shell_slip(camera.radius, spin);
        self.series.push(SeriesPoint {
            time_s: self.series.len() as f64 * interval,
            centre_of_mass_deg: moment.direction().to_degrees(),
            // Without velocities the bed counts as turning with the shell, and no slip is reported.
            shell_slip: spun.unwrap_or(0.0),
            drive_power_w: f64::NAN,
            kinetic_energy_j: f64::NAN,
            airborne_share: None,
        });
        self.moments.push(moment);
    }

    /// Number of moments.
    pub(crate) fn len(&self) -> usize {
        self.series.len()
    }

    /// Time of one swing of the bed as it lies at its first moment, s.
    pub(crate) fn swing(&self) -> f64 {
        let (arm, square) = self
            .moments
            .first()
            .map_or((0.0, 0.0), Moment::arm_and_square);
        let Drive {
            camera, gravity, ..
        } = self.drive;
        swing_time(square, arm, camera.radius, gravity)
    }

    /// What is kept by a rule.
    pub(crate) fn judge(&self, rule: &SteadyRule) -> SteadyState {
        let angles: Vec<f64> = self.series.iter().map(|p| p.centre_of_mass_deg).collect();
        let turns: Vec<bool> = self.series.iter().map(SeriesPoint::rolls).collect();
        rule.judge(&angles, &turns)
    }

    /// Observables, regime and details of what is kept, with a frame every so many moments, and remarks for the user.
    ///
    /// # Errors
    ///
    /// A frame that cannot be drawn.
    pub(crate) fn outcome(
        &self,
        state: SteadyState,
        every: usize,
        took: Took,
        remarks: Vec<String>,
    ) -> Result<RunOutcome, SimulatorError> {
        let kept = &self.series[state.cut.min(self.series.len())..];
        let frames: Vec<usize> = (state.cut..self.len())
            .filter(|k| (k + 1).is_multiple_of(every.max(1)))
            .collect();
        let readings = self.readings(&frames)?;
        let between = self.drive.interval * every.max(1) as f64;
        let surface = SurfaceReadings::of(&readings, Some(between));
        let evidence = self.evidence(kept, &surface);
        let motion = BedMotion::of(&evidence);
        let regime = match state.doubt {
            Some(_) => Some(NOT_STEADY.to_owned()),
            None => word(motion.regime()),
        };
        let mut observables = surface.observables();
        observables.extend(self.of_series(kept, &evidence));
        let details = self.details(state, &frames, &readings, &surface, took)?;
        let details = RunDetails {
            remarks,
            motion: word(motion),
            froude_number: Some(evidence.froude_number),
            ..details
        };
        Ok(RunOutcome {
            observables,
            regime,
            details: serde_json::to_value(details).map_err(SimulatorError::other)?,
        })
    }

    /// The moments as the camera reads them.
    fn readings(&self, frames: &[usize]) -> Result<Vec<FrameReading>, SimulatorError> {
        let moments = frames.iter().filter_map(|k| self.moments.get(*k));
        let read = |moment: &Moment| {
            let spheres: Vec<_> = moment.spheres.iter().map(|s| (s.body, s.sphere)).collect();
            self.drive
                .camera
                .read(&spheres)
                .map_err(SimulatorError::other)
        };
        moments.map(read).collect()
    }

    /// Numbers from which the form of the motion follows.
    fn evidence(&self, kept: &[SeriesPoint], surface: &SurfaceReadings) -> MotionEvidence {
        let Drive {
            camera,
            spin,
            gravity,
            ..
        } = self.drive;
        let froude = camera.radius * spin * spin / gravity;
        let n = surface.s_shape.len() as f64;
        let s_shape = surface.s_shape.iter().sum::<f64>() / n;
        MotionEvidence::of(kept, froude, (n > 0.0).then_some(s_shape), |_| spin)
    }

    /// Observables of the motion of the bed.
    fn of_series(
        &self,
        kept: &[SeriesPoint],
        evidence: &MotionEvidence,
    ) -> BTreeMap<String, Observation> {
        let mass: Vec<f64> = kept.iter().map(|p| p.centre_of_mass_deg).collect();
        let mut all = vec![
            ("centre_of_mass_deg", over_frames(&mass, "deg")),
            ("centre_of_mass_fluctuation_deg", scatter_of(&mass)),
            ("carried_share", over_frames(&[evidence.carried_share], "1")),
        ];
        let waiting: Vec<f64> = evidence.waiting_time.into_iter().collect();
        all.push(("waiting_time_s", over_frames(&waiting, "s")));
        let has_velocities = self.moments.iter().all(|m| {
            let Drive { camera, spin, .. } = self.drive;
            m.shell_slip(camera.radius, spin).is_some()
        });
        if has_velocities {
            let slip: Vec<f64> = kept.iter().map(|p| p.shell_slip).collect();
            all.push(("shell_slip", over_frames(&slip, "1")));
        }
        let told = all.into_iter();
        told.filter_map(|(name, value)| Some((name.to_owned(), value?)))
            .collect()
    }

    /// What a record keeps beside.
    fn details(
        &self,
        state: SteadyState,
        frames: &[usize],
        readings: &[FrameReading],
        surface: &SurfaceReadings,
        took: Took,
    ) -> Result<RunDetails, SimulatorError> {
        let interval = self.drive.interval;
        let times: Vec<f64> = frames.iter().map(|k| *k as f64 * interval).collect();
        let swing = state.swing as f64 * interval;
        let error = error_over_swings(&times, readings, swing);
        let last = frames.last().and_then(|k| self.moments.get(*k));
        let picture = last.map(|moment| {
            let spheres = moment.spheres.iter().map(|s| (s.body, s.sphere));
            self.drive
                .camera
                .picture(spheres)
                .map_err(SimulatorError::other)
        });
        Ok(RunDetails {
            steady: Some(state.doubt.is_none()),
            doubt: state.doubt,
            start_up_s: Some(state.cut as f64 * interval),
            swing_s: Some(swing),
            motion: None,
            froude_number: None,
            no_surface: no_surface(readings),
            remarks: Vec::new(),
            frames: FrameDetails {
                angles_deg: surface.image.clone(),
                angles_by_position_deg: surface.position.clone(),
                filling_angles_deg: Vec::new(),
                refused: readings.iter().filter(|r| r.photo.bed().is_none()).count(),
                no_surface_speed: None,
                standard_error_deg: error,
                effective_number: error.and_then(|e| effective_number(&surface.image, e)),
                times_s: times,
            },
            curve: None,
            series: SeriesDetails {
                time_s: self.series.iter().map(|p| p.time_s).collect(),
                centre_of_mass_deg: self.series.iter().map(|p| p.centre_of_mass_deg).collect(),
            },
            timing: timing(took, self.moments.last().map_or(0, |m| m.spheres.len())),
            last_frame_png_base64: picture.transpose()?.as_ref().map(png_in_base64),
            last_bodies: None,
        })
    }
}

/// What a run cost, with the number of its spheres.
pub(crate) fn timing(took: Took, spheres: usize) -> TimingDetails {
    let steps = took.steps as f64;
    TimingDetails {
        time_step_s: took.time_step,
        settling_time_step_s: took.time_step,
        steps: took.steps,
        bodies: took.bodies,
        spheres,
        threads: took.threads,
        wall_s: took.wall_s,
        cpu_s: None,
        filling_s: None,
        phases: None,
        us_per_step: (steps > 0.0).then(|| took.wall_s * 1e6 / steps),
        sphere_steps_per_s: (steps > 0.0).then(|| spheres as f64 * steps / took.wall_s.max(1e-9)),
        continued: false,
        only_seen: false,
        retried: Vec::new(),
    }
}
