//! Every key of the study file.

/// Keys of the file itself.
pub(crate) const STUDY: [&str; 14] = [
    "name",
    "simulator",
    "effect",
    "scene",
    "parameter",
    "input",
    "coarse_graining",
    "measured",
    "candidate",
    "compare",
    "design",
    "budget",
    "effects",
    "profile",
];
/// Keys of `[[scene]]`.
pub(crate) const SCENE: [&str; 4] = ["name", "file", "changes", "apparatus"];
/// Keys of `[[scene]]` where a program of the user does the runs.
pub(crate) const SCENE_COMMAND: [&str; 4] = ["name", "observables", "parameters", "drum"];
/// Keys of the drum of such a scene.
pub(crate) const DRUM: [&str; 12] = [
    "inner_diameter",
    "width",
    "speed",
    "centre",
    "axis",
    "up",
    "gravity_m_s2",
    "interval",
    "time_step",
    "start_up",
    "pixels",
    "max_angle_error",
];
/// Keys of `[simulator]` for LAMMPS and LIGGGHTS.
pub(crate) const SIMULATOR_PEER: [&str; 6] = [
    "kind",
    "command",
    "ranks",
    "environment",
    "wall_limit",
    "keep",
];
/// Keys of `[simulator]` for a program of the user.
pub(crate) const SIMULATOR_COMMAND: [&str; 8] = [
    "kind",
    "command",
    "template",
    "version",
    "wall_limit",
    "expected",
    "keep",
    "results",
];
/// Keys of the results of such a program.
pub(crate) const RESULTS: [&str; 3] = ["observables", "positions", "pictures"];
/// Keys of `[[effect]]`.
pub(crate) const EFFECT: [&str; 3] = ["name", "probe", "range"];
/// Keys of `[[parameter]]`.
pub(crate) const PARAMETER: [&str; 9] = [
    "symbol", "name", "sets", "unit", "low", "high", "limits", "start", "prior",
];
/// Keys of `[[input]]` of the scenes.
pub(crate) const INPUT: [&str; 8] = [
    "effect", "sets", "symbol", "name", "unit", "mean", "sd", "scenes",
];
/// Keys of `[[input]]` of a program of the user.
pub(crate) const INPUT_COMMAND: [&str; 5] = ["symbol", "name", "unit", "mean", "sd"];
/// Keys of `[coarse_graining]`.
pub(crate) const COARSE_GRAINING: [&str; 3] = ["scenes", "factors", "error"];
/// Keys of `prior`.
pub(crate) const PRIOR: [&str; 2] = ["mean", "sd"];
/// Keys of `[[measured]]` beside the names of observables.
pub(crate) const MEASURED: [&str; 6] = [
    "scene",
    "condition",
    "role",
    "photos",
    "photo",
    "correlation",
];
/// Keys of `[[candidate]]`.
pub(crate) const CANDIDATE: [&str; 6] = ["scene", "condition", "observables", "sd", "n", "minutes"];
/// Keys of an observable.
pub(crate) const VALUE: [&str; 3] = ["mean", "sd", "n"];
/// Keys of `photo`.
pub(crate) const PHOTO: [&str; 16] = [
    "definition",
    "roll",
    "plumb_line",
    "level",
    "elevation",
    "max_angle_error",
    "region",
    "mask",
    "every",
    "drum",
    "corners",
    "foreground",
    "frame_interval",
    "pair_interval",
    "also",
    "leave_out",
];
/// Keys of `[[compare]]`.
pub(crate) const COMPARE: [&str; 4] = ["result", "value", "sd", "source"];
/// Keys of `[design]`: all settings of the loop but the seed, which the command line gives, and the budget.
pub(crate) const DESIGN: [&str; 13] = [
    "surface",
    "replicates",
    "centre_points",
    "screening",
    "screening_alpha",
    "screening_least",
    "before_runs",
    "confirmation_runs",
    "check_runs",
    "most_confirmations",
    "most_boxes",
    "joint",
    "diagnosis_replicates",
];
/// Keys of `[budget]`.
pub(crate) const BUDGET: [&str; 2] = ["runs", "core_hours"];
/// Keys of `[effects]`.
pub(crate) const EFFECTS: [&str; 1] = ["search"];
/// Keys of `[profile.NAME]`.
pub(crate) const PROFILE: [&str; 6] = [
    "design",
    "budget",
    "effects",
    "compare",
    "scene",
    "simulator",
];
/// Keys of a scene in a profile.
pub(crate) const PROFILE_SCENE: [&str; 1] = ["changes"];

/// Every key that a study file may have, by the kind of table; for documentation and its test.
///
/// The names of scenes in a profile, of profiles, of settings in a condition and of observables are free.
pub fn keys_of_a_study() -> Vec<(&'static str, &'static [&'static str])> {
    vec![
        ("study", &STUDY),
        ("scene", &SCENE),
        ("command scene", &SCENE_COMMAND),
        ("drum", &DRUM),
        ("peer simulator", &SIMULATOR_PEER),
        ("command simulator", &SIMULATOR_COMMAND),
        ("results", &RESULTS),
        ("effect", &EFFECT),
        ("parameter", &PARAMETER),
        ("input", &INPUT),
        ("command input", &INPUT_COMMAND),
        ("coarse graining", &COARSE_GRAINING),
        ("prior", &PRIOR),
        ("measured", &MEASURED),
        ("candidate", &CANDIDATE),
        ("value", &VALUE),
        ("photo", &PHOTO),
        ("compare", &COMPARE),
        ("design", &DESIGN),
        ("budget", &BUDGET),
        ("effects", &EFFECTS),
        ("profile", &PROFILE),
        ("profile scene", &PROFILE_SCENE),
    ]
}
