//! Surfaces and a screening of made-up runs, for the tests.

use experiment_design::{Factor, plackett_burman};
use inference::{LeftOut, ModelScreening, ModelSurfaces};
use response_surface::{Fit, Observations, fit, screen};
use std::collections::BTreeMap;

/// Factors F and E over the box 0.1 to 0.6.
fn factors() -> [Factor; 2] {
    ["F", "E"].map(|s| Factor::new(s, &format!("name of {s}"), "1", 0.1, 0.6).unwrap())
}

/// Points of a face-centred design with three centre points, coded.
const FACES: [[f64; 2]; 11] = [
    [-1.0, -1.0],
    [1.0, -1.0],
    [-1.0, 1.0],
    [1.0, 1.0],
    [-1.0, 0.0],
    [1.0, 0.0],
    [0.0, -1.0],
    [0.0, 1.0],
    [0.0, 0.0],
    [0.0, 0.0],
    [0.0, 0.0],
];

/// A quadratic fitted to coded points.
fn fitted(factors: &[Factor], coded: &[Vec<f64>], values: &[f64]) -> Fit {
    let model = response_surface::Model::quadratic(factors).unwrap();
    let data = Observations::from_runs(coded, values).unwrap();
    fit(factors, &model, &data).unwrap()
}

/// Surfaces of the drum over two parameters and of the sled over one.
pub(crate) fn surfaces() -> Vec<ModelSurfaces> {
    let factors = factors();
    let wobble = |k: usize| 0.05 * [1.0, -1.0, 0.5, -0.5][k % 4];
    let drum: Vec<Vec<f64>> = FACES.iter().map(|x| x.to_vec()).collect();
    let drum_angles: Vec<f64> = (0..drum.len())
        .map(|k| 34.0 + 4.0 * drum[k][0] + 1.5 * drum[k][1] - 0.8 * drum[k][0].powi(2) + wobble(k))
        .collect();
    let sled: Vec<Vec<f64>> = [-1.0, -0.5, 0.0, 0.5, 1.0]
        .iter()
        .flat_map(|x| [vec![*x], vec![*x]])
        .collect();
    let pulls: Vec<f64> = (0..sled.len())
        .map(|k| 0.6 + 0.3 * sled[k][0] + 0.1 * wobble(k) + 0.1 * wobble(k / 2))
        .collect();
    let natural = |rows: &[Vec<f64>]| -> Vec<Vec<f64>> {
        let value = |x: &f64| 0.35 + 0.25 * x;
        rows.iter()
            .map(|row| row.iter().map(value).collect())
            .collect()
    };
    let drum_fit = fitted(&factors, &drum, &drum_angles);
    let sled_fit = fitted(&factors[..1], &sled, &pulls);
    let surface = |model: &str, symbols: &[&str], rows: &[Vec<f64>]| ModelSurfaces {
        model: model.into(),
        symbols: symbols.iter().map(|s| (*s).to_owned()).collect(),
        design: "face-centred".into(),
        n_runs: rows.len(),
        left_out: Vec::new(),
        points: natural(rows),
        keys: (0..rows.len()).map(|k| format!("{model}-{k}")).collect(),
        values: BTreeMap::new(),
        shifts: BTreeMap::new(),
        fits: BTreeMap::new(),
    };
    let mut of_drum = surface("drum-15", &["F", "E"], &drum);
    of_drum.values.insert("angle_deg".into(), drum_angles);
    of_drum.fits.insert("angle_deg".into(), Some(drum_fit));
    of_drum.left_out.push(LeftOut {
        point: vec![0.6, 0.1],
        reason: "it slides, and the others roll".into(),
    });
    let mut of_sled = surface("sled", &["F"], &sled);
    of_sled.values.insert("shown_static_friction".into(), pulls);
    of_sled
        .fits
        .insert("shown_static_friction".into(), Some(sled_fit));
    of_sled.fits.insert("pull_force_n".into(), None);
    vec![of_drum, of_sled]
}

/// A screening of the drum in which F matters and E does not.
pub(crate) fn screening() -> ModelScreening {
    let design = plackett_burman(&factors()).unwrap();
    let angle = |x: &[f64]| 30.0 + 3.0 * x[0] + 0.1 * x[4] - 0.05 * x[7];
    let responses: Vec<Option<f64>> = design.coded_rows().iter().map(|x| Some(angle(x))).collect();
    let data = Observations::from_design(&design, &responses).unwrap();
    ModelScreening {
        model: "drum-15".into(),
        n_runs: 12,
        screenings: BTreeMap::from([("angle_deg".into(), screen(&design, &data).unwrap())]),
        kept: vec!["F".into()],
        dropped: vec!["E".into()],
    }
}
