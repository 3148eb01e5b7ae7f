//! How large a calibration is: designs, numbers of runs, budget.

use serde::{Deserialize, Serialize};

/// The design behind a response surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SurfaceDesign {
    /// What fits the number of parameters: five levels of one, central composite of two, Box-Behnken of three to
    /// seven, a Latin hypercube beyond.
    #[default]
    Auto,
    /// Central composite on the faces of the box, 2 to 8 parameters.
    CentralComposite,
    /// Box-Behnken, 3 to 7 parameters.
    BoxBehnken,
    /// D-optimal for a quadratic, with half as many runs again as terms; its search takes minutes beyond eight
    /// parameters.
    DOptimal,
    /// Latin hypercube with half as many runs again as a quadratic has terms.
    LatinHypercube,
    /// Two levels and centre points, for a plane.
    Linear,
}

/// When parameters are screened before a surface is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ScreeningChoice {
    /// For models with more than five parameters.
    #[default]
    Auto,
    /// Always, where a model has two parameters or more.
    Always,
    /// Never.
    Never,
}

/// How a calibration is done; every value is part of the result.
///
/// ```
/// use inference::LoopSettings;
/// // At most 60 runs in all; everything else as usual.
/// let settings = LoopSettings { most_runs: Some(60), ..LoopSettings::default() };
/// assert_eq!(settings.confirmation_runs, 3);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LoopSettings {
    /// Design behind each surface.
    pub surface: SurfaceDesign,
    /// Runs of each point of a design.
    pub replicates: usize,
    /// Centre points of a design; they show the noise.
    pub centre_points: usize,
    /// When to screen.
    pub screening: ScreeningChoice,
    /// Level at which a parameter passes the screening.
    pub screening_alpha: f64,
    /// Fewest parameters that pass the screening.
    pub screening_least: usize,
    /// Runs of each model with the parameters in use before; 0 leaves that comparison out.
    pub before_runs: usize,
    /// Fresh runs of each model that confirm the estimate.
    pub confirmation_runs: usize,
    /// Runs of each model that is kept for the check, or shown.
    pub check_runs: usize,
    /// Most rounds of confirmation, in which runs that contradict a surface correct it.
    pub most_confirmations: usize,
    /// Most boxes, the first included, while the measurements are out of reach.
    pub most_boxes: usize,
    /// Whether a joint estimate from all measurements, checks included, follows the check.
    pub joint: bool,
    /// Runs behind each simulated mean of the diagnosis: 2 or more.
    pub diagnosis_replicates: usize,
    /// Most runs of all stages together: no box is begun and no diagnosis made that could need more. Without a limit
    /// if omitted.
    pub most_runs: Option<usize>,
    /// First seed; each model and point takes those that follow.
    pub seed: u64,
}

impl Default for LoopSettings {
    fn default() -> Self {
        Self {
            surface: SurfaceDesign::Auto,
            replicates: 1,
            centre_points: 3,
            screening: ScreeningChoice::Auto,
            screening_alpha: 0.05,
            screening_least: 2,
            before_runs: 2,
            confirmation_runs: 3,
            check_runs: 4,
            most_confirmations: 3,
            most_boxes: 6,
            joint: true,
            diagnosis_replicates: 2,
            most_runs: None,
            seed: 1,
        }
    }
}
