//! What a study gives; the content of `result.json`.

use calibration::{PointResult, ResidualStudy, ScreeningResult, SurfaceResult, Validation};
use response_surface::Solutions;
use serde::Serialize;
use sphere_fill::FitReport;
use std::collections::BTreeMap;

/// Result of a study.
#[derive(Debug, Clone, Serialize)]
pub struct StudyResult {
    /// Name of the study.
    pub name: String,
    /// Profile.
    pub profile: String,
    /// Version of the program.
    pub version: String,
    /// First seed.
    pub seed: u64,
    /// SHA-256 of each input file.
    pub inputs: BTreeMap<String, String>,
    /// Seeds as bodies.
    pub fillings: Vec<FillingSummary>,
    /// Plackett-Burman screening.
    pub screening: ScreeningResult,
    /// Symbols of the factors that went on.
    pub kept_factors: Vec<String>,
    /// Box-Behnken design and quadratic surface.
    pub surface: SurfaceResult,
    /// Solutions for the measured angle.
    pub solutions: Solutions,
    /// The solution taken: values of all factors by symbol.
    pub chosen: BTreeMap<String, f64>,
    /// Whether the chosen point is a solution, or the nearest that the surface reaches.
    pub target_reached: bool,
    /// Fresh runs at the chosen point.
    pub validation: Validation,
    /// Runs at the published optimum.
    pub published_optimum: PointResult,
    /// Angle against one parameter.
    pub sweep: Vec<SweepPoint>,
    /// Image angle against position angle over all drum runs of the calibration.
    pub image_against_position: ImageAgainstPosition,
    /// Metering device.
    pub metering: MeteringResult,
    /// Residual at the bench measurements.
    pub residual: ResidualStudy,
    /// Angle at the bench measurements against the smoothness of the filling.
    pub smoothness: Vec<SweepPoint>,
    /// Campaign with a hidden effect.
    pub hidden: HiddenCampaign,
    /// The same with nothing hidden.
    pub nothing_hidden: HiddenCampaign,
    /// What this profile reduces and what it costs.
    pub cost: Cost,
    /// What a reader should know.
    pub remarks: Vec<String>,
}

/// A seed as a body.
#[derive(Debug, Clone, Serialize)]
pub struct FillingSummary {
    /// Name of the seed.
    pub name: String,
    /// Number of spheres.
    pub spheres: usize,
    /// Number that something outside can touch.
    pub outer_spheres: usize,
    /// Mass of the seed, kg.
    pub mass_kg: f64,
    /// Density of the spheres by eq. (9), kg/m³.
    pub fraction_density_kg_m3: f64,
    /// Volume of the mesh, mm³.
    pub mesh_volume_mm3: f64,
    /// Fit; lengths in m.
    pub fit: FitReport,
}

/// A point of a sweep.
#[derive(Debug, Clone, Serialize)]
pub struct SweepPoint {
    /// Value of the swept quantity.
    pub value: f64,
    /// Runs.
    pub result: PointResult,
    /// Regime of the first run.
    pub regime: String,
    /// Slip at the shell of the first run, 1.
    pub shell_slip: f64,
}

/// Image angle minus position angle.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct ImageAgainstPosition {
    /// Number of runs.
    pub n_runs: usize,
    /// Number of frames.
    pub n_frames: usize,
    /// Mean over the runs, deg.
    pub mean_deg: f64,
    /// Standard deviation of the means of the runs, deg.
    pub sd_of_runs_deg: f64,
    /// Mean standard deviation over the frames of a run, deg.
    pub sd_of_frames_deg: f64,
}

/// Filling angle of the metering device.
#[derive(Debug, Clone, Serialize)]
pub struct MeteringResult {
    /// Runs; deg.
    pub result: PointResult,
    /// Published measurement: mean and sd, deg.
    pub published_measured_deg: [f64; 2],
    /// Published simulation: mean and sd, deg.
    pub published_simulated_deg: [f64; 2],
    /// 100 |mean - measured| / measured, %.
    pub difference_percent: f64,
}

/// A campaign on measured-like data.
#[derive(Debug, Clone, Serialize)]
pub struct HiddenCampaign {
    /// The effect that made the data; none where nothing was hidden.
    pub hidden_effect: Option<String>,
    /// Its amplitude; 0 where nothing was hidden.
    pub hidden_amplitude: f64,
    /// Parameters that made the data, by name.
    pub true_parameters: BTreeMap<String, f64>,
    /// The study of the residual.
    pub study: ResidualStudy,
    /// Whether the verdict is right: the hidden effect named alone, or nothing named.
    pub verdict_is_right: bool,
}

/// What the runs cost.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Cost {
    /// Number of different runs of this result.
    pub n_runs: usize,
    /// Sum of their times, s.
    pub run_time_s: f64,
    /// Mean time of a drum run of the calibration, s.
    pub drum_run_s: f64,
    /// Steps of these drum runs in a second, mean.
    pub drum_steps_per_s: f64,
    /// Runs that the profile `study` needs.
    pub study_profile_runs: usize,
    /// What profile `study` would cost by the measured time per run, hours of one core.
    pub study_profile_core_hours: f64,
}
