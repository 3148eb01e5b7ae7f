//! The files of a passport.

use crate::Error;
use crate::case::{Case, Start};
use crate::codes;
use crate::expected::Expected;
use crate::model::Model;
use crate::packing::Packing;
use crate::readme::readme;
use crate::results::{HEADER, template};
use crate::small_cases::cases;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;

/// Name of the file that `--check` reads beside the results.
pub const PASSPORT: &str = "passport.json";

/// A calibrated value with its uncertainty.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Calibrated {
    /// Symbol.
    pub symbol: String,
    /// Name.
    pub name: String,
    /// Settings that it sets.
    pub sets: Vec<String>,
    /// Value.
    pub value: f64,
    /// Unit; 1 if it has none.
    pub unit: String,
    /// Standard error, if anything fixes the value.
    pub se: Option<f64>,
    /// 95 % interval.
    pub interval95: Option<[f64; 2]>,
}

/// Covariance of calibrated values from their standard errors and correlation: `se_i se_j r_ij`.
pub fn covariance(calibrated: &[Calibrated], correlation: &[Vec<f64>]) -> Vec<Vec<Option<f64>>> {
    let row = |(of, row): (&Calibrated, &Vec<f64>)| {
        let each = calibrated.iter().zip(row);
        each.map(|(with, r)| Some(of.se? * with.se? * r)).collect()
    };
    calibrated.iter().zip(correlation).map(row).collect()
}

/// Grains of one kind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Grain {
    /// Name in the scene.
    pub name: String,
    /// Diameter of the sphere of equal volume, m.
    pub diameter_m: f64,
    /// Spheres of one grain.
    pub spheres: usize,
}

/// Where the values hold.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Validity {
    /// Whether fit and checks were met; `None` if unknown.
    pub met: Option<bool>,
    /// Verdict of the calibration.
    pub verdict: Option<String>,
    /// Measurements that the values were fitted to or checked with, one line each: scene, condition, observable, role, regime.
    pub measurements: Vec<String>,
    /// Apparatus of the scene.
    pub apparatus: String,
    /// Grains of the scene.
    pub grains: Vec<Grain>,
    /// Highest speed, m/s: of its wall, or of a fall through it.
    pub speed_m_s: f64,
    /// Highest stress, Pa: weight of a bed as deep as the apparatus over its area.
    pub stress_pa: f64,
    /// Regimes of the runs at the estimate; empty if unknown.
    pub regimes: Vec<String>,
}

/// All that the folder states, for programs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Passport {
    /// Version of seedloop.
    pub version: String,
    /// Parameters and conventions.
    pub model: Model,
    /// Calibrated values.
    pub calibrated: Vec<Calibrated>,
    /// Correlation of the calibrated values, if known.
    pub correlation: Option<Vec<Vec<f64>>>,
    /// Their covariance, if known, in the product of the units of row and column; `None` beside a value that nothing fixes.
    pub covariance: Option<Vec<Vec<Option<f64>>>>,
    /// Where they hold.
    pub validity: Validity,
    /// Expected numbers of the self-test.
    pub expected: Vec<Expected>,
}

/// A file of the folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct File {
    /// Name.
    pub name: &'static str,
    /// Text.
    pub text: String,
}

/// The files of a passport.
///
/// # Errors
///
/// Numbers that have no form in JSON.
pub fn files(passport: &Passport) -> Result<Vec<File>, Error> {
    let json =
        serde_json::to_string_pretty(passport).map_err(|source| Error::Json(source.to_string()))?;
    let model = &passport.model;
    let cases = cases(model);
    let file = |name, text| File { name, text };
    let fixed = |name, text: &str| file(name, text.to_owned());
    let covariance = passport.covariance.as_ref();
    let mut files: Vec<File> = covariance
        .map(|rows| file("covariance.csv", covariances(&passport.calibrated, rows)))
        .into_iter()
        .collect();
    files.extend([
        file("README.md", readme(passport, &cases)),
        file(PASSPORT, json + "\n"),
        file("runs.csv", runs(model, &cases)),
        file("walls.csv", walls(model, &cases)),
        file("bodies.csv", bodies(model, &cases)),
        file("spheres.csv", spheres(model, &cases)),
        file("expected.csv", expected(&passport.expected)),
        file("RESULTS.csv", template(&passport.expected)),
        file(
            "other-codes.md",
            include_str!("folder/other-codes.md").replace("{codes}", &codes::table()),
        ),
        fixed("run_lammps.py", include_str!("folder/run_lammps.py")),
        fixed("run_liggghts.py", include_str!("folder/run_liggghts.py")),
        fixed("run_yade.py", include_str!("folder/run_yade.py")),
        fixed("cases.py", include_str!("folder/cases.py")),
    ]);
    Ok(files)
}

/// Adds a line to a table.
fn line(text: &mut String, cells: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = text.write_fmt(cells);
    text.push('\n');
}

/// The covariance: a row and a column for each symbol; a cell is in the product of both units, and empty if nothing fixes the value.
fn covariances(calibrated: &[Calibrated], rows: &[Vec<Option<f64>>]) -> String {
    let symbols: Vec<&str> = calibrated.iter().map(|c| c.symbol.as_str()).collect();
    let mut text = format!("symbol,unit,{}\n", symbols.join(","));
    for (of, row) in calibrated.iter().zip(rows) {
        let cells = row
            .iter()
            .map(|x| x.map_or(String::new(), |x| format!("{x:e}")));
        let cells: Vec<String> = cells.collect();
        line(
            &mut text,
            format_args!("{},{},{}", of.symbol, of.unit, cells.join(",")),
        );
    }
    text
}

/// Numbers as cells.
fn cells(v: &Vector3<f64>) -> String {
    format!("{:e},{:e},{:e}", v.x, v.y, v.z)
}

/// Time step, gravity and times of each case.
fn runs(model: &Model, cases: &[Case]) -> String {
    let mut text =
        "case,time_step_s,gravity_x_m_s2,gravity_y_m_s2,gravity_z_m_s2,t1_s,t2_s\n".to_owned();
    for case in cases {
        let last = case
            .times
            .get(1)
            .map_or(String::new(), |t| format!("{t:e}"));
        let gravity = cells(&case.gravity);
        line(
            &mut text,
            format_args!(
                "{},{:e},{gravity},{:e},{last}",
                case.name, case.time_step, case.times[0]
            ),
        );
    }
    for packing in Packing::ALL {
        let [time_step, duration] = packing.times(model);
        let gravity = cells(&packing.gravity(model));
        line(
            &mut text,
            format_args!("{},{time_step:e},{gravity},{duration:e},", packing.name()),
        );
    }
    text
}

/// Planes of each case.
fn walls(model: &Model, cases: &[Case]) -> String {
    let mut text = "case,x_m,y_m,z_m,normal_x,normal_y,normal_z\n".to_owned();
    for case in cases.iter().filter(|case| case.wall) {
        line(
            &mut text,
            format_args!(
                "{},{},{}",
                case.name,
                cells(&Vector3::zeros()),
                cells(&Vector3::y())
            ),
        );
    }
    for packing in Packing::ALL {
        for [point, normal] in packing.planes(model) {
            line(
                &mut text,
                format_args!("{},{},{}", packing.name(), cells(&point), cells(&normal)),
            );
        }
    }
    text
}

/// Mass (kg) and inertia about the axes of the world (kg m²) of a body at its start.
fn mass_and_inertia(model: &Model, start: &Start) -> (f64, Matrix3<f64>) {
    let (mass, radius) = (model.mass(), model.radius_m);
    let centres = start.shape.centres(radius);
    let of_sphere = Matrix3::identity() * (0.4 * mass * radius * radius);
    let inertia: Matrix3<f64> = centres
        .iter()
        .map(|centre| {
            let c = start.orientation * centre;
            of_sphere + (Matrix3::identity() * c.norm_squared() - c * c.transpose()) * mass
        })
        .sum();
    (mass * centres.len() as f64, inertia)
}

/// All bodies by case, packings behind the small cases.
fn starts(model: &Model, cases: &[Case]) -> Vec<(&'static str, usize, Start)> {
    let small = cases.iter().flat_map(|case| {
        let bodies = (1..).zip(&case.bodies);
        bodies.map(|(number, start)| (case.name, number, start.clone()))
    });
    let packed = Packing::ALL.into_iter().flat_map(|packing| {
        let centres = packing.starts(model, 1);
        (1..).zip(centres).map(move |(number, position)| {
            let start = Start {
                shape: crate::case::Shape::Sphere,
                position,
                orientation: UnitQuaternion::identity(),
                velocity: Vector3::zeros(),
                spin: Vector3::zeros(),
            };
            (packing.name(), number, start)
        })
    });
    small.chain(packed).collect()
}

/// Bodies at their start.
fn bodies(model: &Model, cases: &[Case]) -> String {
    let mut text = "case,body,mass_kg,x_m,y_m,z_m,velocity_x_m_s,velocity_y_m_s,velocity_z_m_s,spin_x_rad_s,spin_y_rad_s,\
                    spin_z_rad_s,inertia_xx_kg_m2,inertia_yy_kg_m2,inertia_zz_kg_m2,inertia_xy_kg_m2,inertia_xz_kg_m2,inertia_yz_kg_m2\n"
        .to_owned();
    for (case, number, start) in starts(model, cases) {
        let (mass, i) = mass_and_inertia(model, &start);
        let motion = [&start.position, &start.velocity, &start.spin]
            .map(cells)
            .join(",");
        let diagonal = cells(&Vector3::new(i.m11, i.m22, i.m33));
        let products = cells(&Vector3::new(i.m12, i.m13, i.m23));
        line(
            &mut text,
            format_args!("{case},{number},{mass:e},{motion},{diagonal},{products}"),
        );
    }
    text
}

/// Spheres of the bodies at their start.
fn spheres(model: &Model, cases: &[Case]) -> String {
    let mut text = "case,body,x_m,y_m,z_m,radius_m\n".to_owned();
    for (case, number, start) in starts(model, cases) {
        for centre in start.shape.centres(model.radius_m) {
            let place = cells(&(start.position + start.orientation * centre));
            line(
                &mut text,
                format_args!("{case},{number},{place},{:e}", model.radius_m),
            );
        }
    }
    text
}

/// The expected numbers.
fn expected(rows: &[Expected]) -> String {
    let mut text = format!("{HEADER},band,closed_form\n");
    for row in rows {
        let closed_form = row
            .closed_form
            .map_or(String::new(), |value| format!("{value:e}"));
        line(
            &mut text,
            format_args!(
                "{},{},{},{:e},{:e},{closed_form}",
                row.case, row.quantity, row.unit, row.value, row.band
            ),
        );
    }
    text
}
