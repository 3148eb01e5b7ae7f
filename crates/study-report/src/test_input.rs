//! A calibration made by hand, with something in every part of it, for the tests.

use crate::test_surfaces::{screening, surfaces};
use crate::{ComparedValue, CurvePoints, ReportInput};
use campaign::run_store::Record;
use dev_support::fixture_files::fixture;
use inference::{
    Calibration, CalibrationProblem, Comparison, ConfirmationRound, ConfirmationRow,
    DiagnosisStage, Estimate, FitTest, JointEstimate, JointPrediction, LoopSettings, MeasuredMean,
    Measurement, Model, OpenCombination, Parameter, Prior, Role, SearchBox, SimulatedMean,
    SolutionSet, StageCost,
};
use scene::{FillingLibrary, PhaseTimes, Scene, TimeSpent};
use std::collections::BTreeMap;

/// Owner of everything that an input borrows.
#[derive(Debug)]
pub(crate) struct Example {
    pub(crate) name: String,
    pub(crate) inputs: BTreeMap<String, String>,
    pub(crate) problem: CalibrationProblem,
    pub(crate) calibration: Calibration,
    pub(crate) compare: Vec<ComparedValue>,
    pub(crate) defaults: Vec<String>,
    pub(crate) scenes: BTreeMap<String, Scene>,
    pub(crate) fillings: FillingLibrary,
    pub(crate) records: BTreeMap<String, Record>,
    pub(crate) curves: Vec<CurvePoints>,
}

impl Example {
    pub(crate) fn input(&self) -> ReportInput<'_> {
        ReportInput {
            name: &self.name,
            profile: "quick",
            version: "9.8.7",
            seed: 41,
            inputs: &self.inputs,
            problem: &self.problem,
            calibration: &self.calibration,
            compare: &self.compare,
            defaults: &self.defaults,
            scenes: &self.scenes,
            fillings: &self.fillings,
            records: &self.records,
            curves: &self.curves,
            spent: spent(),
        }
    }

    /// Nothing but the fit: no screening, check, show, joint estimate, box, surface, seed or value of others.
    pub(crate) fn bare() -> Self {
        let mut bare = example();
        bare.problem.measurements.retain(|m| m.role == Role::Fit);
        let c = &mut bare.calibration;
        c.before.clear();
        c.fit.truncate(2);
        c.check.clear();
        c.show.clear();
        c.screening.clear();
        c.boxes.clear();
        c.surfaces.clear();
        c.confirmations.clear();
        c.joint = None;
        c.open_combinations.clear();
        c.remarks.clear();
        c.cost.clear();
        bare.compare.clear();
        bare.defaults.clear();
        bare.inputs.clear();
        bare.scenes.clear();
        bare.records.clear();
        bare
    }
}

/// An estimate with limits 0 to 1.5 and an interval of two standard errors.
pub(crate) fn estimate(symbol: &str, value: f64, se: Option<f64>) -> Estimate {
    let half = 2.0 * se.unwrap_or(0.1);
    Estimate {
        symbol: symbol.into(),
        name: format!("name of {symbol}"),
        unit: "1".into(),
        sets: vec![format!("contact.{symbol}")],
        start: 0.1,
        value,
        se,
        interval95: [value - half, value + half],
        fixed_by_data: true,
        at_limit: false,
        limits: [0.0, 1.5],
    }
}

/// A condition of one setting.
fn condition(path: &str, value: &str) -> BTreeMap<String, String> {
    BTreeMap::from([(path.to_owned(), value.to_owned())])
}

/// A measured mean of ten values.
pub(crate) fn measured(
    model: usize,
    observable: &str,
    role: Role,
    mean: f64,
    sd: f64,
) -> Measurement {
    Measurement {
        model,
        observable: observable.into(),
        role,
        mean,
        sd,
        n: 10.0,
        is_scatter: false,
    }
}

/// What was measured; the order of the file is not that of the report.
fn measurements() -> Vec<Measurement> {
    vec![
        measured(2, "angle_deg", Role::Check, 35.2, 0.9),
        measured(0, "shown_static_friction", Role::Fit, 0.56, 0.03),
        measured(1, "angle_deg", Role::Fit, 33.1, 0.8),
        measured(3, "angle_deg", Role::Show, 21.4, 0.6),
    ]
}

/// Two parameters, four models, five measurements.
fn problem() -> CalibrationProblem {
    let parameter = |symbol: &str, prior| Parameter {
        symbol: symbol.into(),
        name: format!("name of {symbol}"),
        unit: "1".into(),
        sets: vec![format!("contact.{symbol}")],
        range: [0.1, 0.6],
        limits: [0.0, 1.5],
        start: 0.1,
        prior,
        is_input: false,
    };
    let model = |name: &str, scene: &str, condition, parameters: &[usize]| Model {
        name: name.into(),
        scene: scene.into(),
        condition,
        parameters: parameters.to_vec(),
    };
    CalibrationProblem {
        id: "peas".into(),
        parameters: vec![
            parameter("F", None),
            parameter(
                "E",
                Some(Prior {
                    mean: 0.4,
                    sd: 0.05,
                }),
            ),
        ],
        models: vec![
            model("sled", "sled", BTreeMap::new(), &[0]),
            model(
                "drum-15",
                "drum",
                condition("apparatus.speed", "15 rpm"),
                &[0, 1],
            ),
            model(
                "drum-30",
                "drum",
                condition("apparatus.speed", "30 rpm"),
                &[0, 1],
            ),
            model("funnel", "funnel", BTreeMap::new(), &[0]),
        ],
        measurements: measurements(),
        correlations: Vec::new(),
        effects: Vec::new(),
        candidates: Vec::new(),
        coarse_graining: None,
    }
}

/// A comparison of the measurement with a number.
fn comparison(problem: &CalibrationProblem, i: usize, mean: f64, z: f64) -> Comparison {
    let m = &problem.measurements[i];
    let model = &problem.models[m.model];
    Comparison {
        scene: model.scene.clone(),
        condition: model.condition.clone(),
        observable: m.observable.clone(),
        role: m.role,
        measured: MeasuredMean {
            mean: m.mean,
            sd: m.sd,
            n: m.n,
        },
        simulated: SimulatedMean {
            mean,
            se: if mean > 1.0 { 0.12 } else { 0.012 },
            n_runs: 4,
        },
        parameter_se: Some(0.31),
        reach: None,
        z,
        z_limit: 2.26,
        holds: z.abs() <= 2.26,
        regimes: BTreeMap::from([("rolling".into(), 3), ("slumping".into(), 1)]),
        keys: Vec::new(),
    }
}

fn joint() -> JointEstimate {
    JointEstimate {
        parameters: vec![
            estimate("F", 0.34, Some(0.01)),
            estimate("E", 0.41, Some(0.03)),
        ],
        inputs: Vec::new(),
        correlation: vec![vec![1.0, -0.55], vec![-0.55, 1.0]],
        test: FitTest {
            misfit: 4.4,
            degrees_of_freedom: 2,
            p: Some(0.1108),
        },
        predicted: vec![JointPrediction {
            scene: "drum".into(),
            condition: condition("apparatus.speed", "30 rpm"),
            observable: "angle_deg".into(),
            measured: 35.2,
            predicted: 35.552,
            se: 0.2,
        }],
    }
}

/// A set of solutions along a line, with two best points.
fn solutions() -> SolutionSet {
    let share = |k: u32| f64::from(k) / 40.0;
    SolutionSet {
        share_of_box: 0.042,
        extent: vec![[0.28, 0.38], [0.31, 0.49]],
        separate: vec![vec![0.33, 0.4], vec![0.29, 0.47]],
        points: (0..40_u32)
            .map(|k| vec![0.28 + 0.1 * share(k), 0.49 - 0.18 * share(k)])
            .collect(),
    }
}

/// A round of three runs that agree with the surface.
fn confirmation() -> ConfirmationRound {
    ConfirmationRound {
        at: vec![0.33, 0.4],
        rows: vec![ConfirmationRow {
            model: "drum-15".into(),
            observable: "angle_deg".into(),
            predicted: 33.4,
            predicted_se: 0.2,
            simulated: SimulatedMean {
                mean: 33.2,
                se: 0.12,
                n_runs: 3,
            },
            z: 0.9,
            matters: true,
        }],
        confirmed: true,
    }
}

/// Cost of a stage.
/// A hundred seconds of runs, of which each phase took a part of its own.
pub(crate) fn spent() -> TimeSpent {
    let phases = PhaseTimes {
        building_s: 2.0,
        settling_s: 13.0,
        start_up_s: 35.0,
        measuring_s: 41.0,
        reading_s: 9.0,
    };
    TimeSpent {
        core_s: 98.0,
        phases,
        wall_s: 54.0,
        waiting_s: Some(10.0),
    }
}

fn cost(stage: &str, runs: usize, wall_s: f64) -> StageCost {
    StageCost {
        stage: stage.into(),
        runs,
        wall_s,
    }
}

/// The result.
fn calibration(problem: &CalibrationProblem) -> Calibration {
    let compared = |i, mean, z| comparison(problem, i, mean, z);
    let search_box = |why: &str, low: f64| SearchBox {
        low: vec![low, 0.1],
        high: vec![low + 0.5, 0.6],
        why: why.into(),
        best: vec![0.33, 0.4],
        misfit: 0.61,
        n_runs: 21,
    };
    Calibration {
        id: "peas".into(),
        settings: LoopSettings::default(),
        parameters: vec![
            estimate("F", 0.33, Some(0.021)),
            estimate("E", 0.4, Some(0.05)),
        ],
        inputs: Vec::new(),
        correlation: vec![vec![1.0, -0.62], vec![-0.62, 1.0]],
        open_combinations: vec![OpenCombination {
            weights: BTreeMap::from([("F".into(), 0.7), ("E".into(), -0.71)]),
            se_in_widths: None,
        }],
        test: FitTest {
            misfit: 0.61,
            degrees_of_freedom: 1,
            p: Some(0.4348),
        },
        solutions: solutions(),
        before: vec![
            compared(0, 31.9, 10.6),
            compared(1, 0.24, 20.9),
            compared(2, 30.4, 9.6),
            compared(3, 20.1, 5.9),
        ],
        fit: vec![compared(1, 0.555, 0.3), compared(2, 33.25, -0.5)],
        check: vec![compared(0, 36.3, -3.6)],
        show: vec![compared(3, 21.6, -0.9)],
        screening: vec![screening()],
        boxes: vec![
            search_box("as the file says", 0.1),
            search_box("moved", 0.2),
        ],
        surfaces: surfaces(),
        size_trends: Vec::new(),
        confirmations: vec![confirmation()],
        joint: Some(joint()),
        diagnosis: DiagnosisStage::LeftOut {
            reason: "no effect was asked for".into(),
        },
        next_for_parameters: None,
        with_effects: None,
        remarks: vec!["Two points slide.".into()],
        met: false,
        verdict: "The fit is met; the check at 30 rpm is missed by 3.6 standard errors.".into(),
        cost: vec![cost("surfaces", 21, 30.25), cost("check", 4, 8.0)],
    }
}

/// Everything, with a picture and a seed.
pub(crate) fn example() -> Example {
    let problem = problem();
    let mut calibration = calibration(&problem);
    let record = crate::test_scene::record();
    calibration.check[0].keys = vec!["lost".into(), record.key().to_owned()];
    let fixtures = fixture("");
    let drum = crate::test_scene::drum(&fixtures.join("stl"));
    let scenes = ["drum-15", "drum-30"].map(|name| (name.to_owned(), drum.clone()));
    Example {
        name: "peas".into(),
        inputs: BTreeMap::from([("drum.toml".into(), "ab12".into())]),
        problem,
        calibration,
        compare: vec![ComparedValue {
            result: "funnel angle_deg".into(),
            found: Some(21.6),
            se: Some(0.12),
            value: 22.9,
            sd: Some(0.7),
            source: "a handbook, p. 3".into(),
        }],
        defaults: vec!["loop.replicates: 1".into()],
        scenes: scenes.into(),
        fillings: FillingLibrary::default(),
        records: BTreeMap::from([(record.key().to_owned(), record)]),
        curves: Vec::new(),
    }
}
