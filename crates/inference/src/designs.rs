//! Which design fits the number of parameters, and its points in a box.

use crate::region::Region;
use crate::samples::{Asked, Wanted, wanted};
use crate::{Error, LoopSettings, SurfaceDesign};
use experiment_design::{
    AxialDistance, Criterion, Factor, box_behnken, central_composite, fractional_factorial,
    full_factorial, latin_hypercube, optimal_design, plackett_burman,
};
use response_surface::Model;

/// Levels of a single parameter: one more than a parabola needs on each side of the middle, so that its lack of fit can
/// be seen.
const LEVELS_OF_ONE: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];
/// Runs of a Latin hypercube or a D-optimal design over the number of terms of the quadratic.
const RUNS_OVER_TERMS: f64 = 1.5;
/// Most parameters of a full two-level factorial; its half is taken for one more, a Plackett-Burman design beyond.
const MOST_FACTORIAL: usize = 3;
/// Runs with finer grains of a model that no parameter acts on.
const FINER_AT_A_POINT: usize = 4;

/// A design in coordinates of the box, -1 to 1.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CodedDesign {
    /// Its name, for the reader.
    pub(crate) name: String,
    /// Coded rows, (runs, parameters).
    pub(crate) rows: Vec<Vec<f64>>,
}

pub(crate) fn coded_factors(symbols: &[String]) -> Result<Vec<Factor>, Error> {
    let factors = symbols.iter().map(|s| Factor::coded_only(s));
    Ok(factors.collect::<Result<_, _>>()?)
}

/// The design behind the surfaces of a model with these parameters.
///
/// # Errors
///
/// A design that does not exist for so many parameters.
pub(crate) fn surface_design(
    symbols: &[String],
    settings: &LoopSettings,
) -> Result<CodedDesign, Error> {
    let factors = coded_factors(symbols)?;
    let centre = settings.centre_points;
    let kind = match (settings.surface, factors.len()) {
        (_, 0) => {
            return Ok(CodedDesign {
                name: "repeats".into(),
                rows: repeated(vec![Vec::new(); centre.max(2)], settings.replicates),
            });
        }
        // One parameter has one good design whatever is asked for of more.
        (SurfaceDesign::Linear, _) => SurfaceDesign::Linear,
        (_, 1) => return Ok(levels_of_one(settings)),
        (SurfaceDesign::Auto, 2) => SurfaceDesign::CentralComposite,
        (SurfaceDesign::Auto, 3..=7) => SurfaceDesign::BoxBehnken,
        (SurfaceDesign::Auto, _) => SurfaceDesign::LatinHypercube,
        (kind, _) => kind,
    };
    let (name, rows) = match kind {
        SurfaceDesign::Linear => return two_level(symbols, centre, settings.replicates),
        SurfaceDesign::CentralComposite => {
            let design = central_composite(&factors, AxialDistance::Face, centre)?;
            ("central composite", design.coded_rows())
        }
        SurfaceDesign::BoxBehnken => ("Box-Behnken", box_behnken(&factors, centre)?.coded_rows()),
        SurfaceDesign::LatinHypercube | SurfaceDesign::Auto => {
            let n = runs_for(&Model::quadratic(&factors)?);
            let design = latin_hypercube(&factors, n, settings.seed)?;
            ("Latin hypercube", design.coded_rows())
        }
        SurfaceDesign::DOptimal => {
            let model = Model::quadratic(&factors)?;
            let n = runs_for(&model);
            let row = |x: &[f64]| model.row(x);
            let d = optimal_design(&factors, Criterion::Determinant, n, settings.seed, &row)?;
            ("D-optimal", d.coded_rows())
        }
    };
    Ok(CodedDesign {
        name: name.into(),
        rows: repeated(rows, settings.replicates),
    })
}

/// Runs of a design that is made for the number of terms of a model.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a number of terms of at most 91"
)]
fn runs_for(model: &Model) -> usize {
    (model.terms().len() as f64 * RUNS_OVER_TERMS).ceil() as usize
}

/// Five levels of one parameter, with further runs at the middle.
fn levels_of_one(settings: &LoopSettings) -> CodedDesign {
    let levels = LEVELS_OF_ONE.iter().map(|x| vec![*x]);
    let further = std::iter::repeat_n(vec![0.0], settings.centre_points.saturating_sub(1));
    CodedDesign {
        name: "five levels".into(),
        rows: repeated(levels.chain(further).collect(), settings.replicates),
    }
}

/// Two levels of each parameter with centre runs, for a plane: a full factorial up to three parameters, half of one for
/// four, Plackett-Burman beyond.
///
/// # Errors
///
/// More parameters than such a design takes.
pub(crate) fn two_level(
    symbols: &[String],
    centre_points: usize,
    replicates: usize,
) -> Result<CodedDesign, Error> {
    let factors = coded_factors(symbols)?;
    let n = factors.len();
    let mut rows = match n {
        0..=MOST_FACTORIAL => full_factorial(&factors, 0)?.coded_rows(),
        4 => fractional_factorial(&factors, 1, 0)?.design.coded_rows(),
        _ => plackett_burman(&factors)?.coded_rows(),
    };
    // Columns behind the parameters are dummies: they set nothing.
    for row in &mut rows {
        row.truncate(n);
    }
    rows.extend(std::iter::repeat_n(vec![0.0; n], centre_points));
    Ok(CodedDesign {
        name: "two levels".into(),
        rows: repeated(rows, replicates),
    })
}

/// Points about a middle that show the slope along each parameter with few runs: one more than parameters, and four at
/// the least. The middle itself is run elsewhere. D-optimal for a plane; full factorials of one and two parameters.
///
/// # Errors
///
/// More parameters than such a design takes.
pub(crate) fn slope_design(symbols: &[String], seed: u64) -> Result<Vec<Vec<f64>>, Error> {
    let factors = coded_factors(symbols)?;
    let n = factors.len();
    if n <= 2 {
        let rows = full_factorial(&factors, 0)?.coded_rows();
        let times = 4 / rows.len();
        return Ok(repeated(rows, times));
    }
    let model = Model::linear(&factors)?;
    let row = |x: &[f64]| model.row(x);
    let design = optimal_design(&factors, Criterion::Determinant, n + 1, seed, &row)?;
    Ok(design.coded_rows())
}

fn repeated(rows: Vec<Vec<f64>>, times: usize) -> Vec<Vec<f64>> {
    let each = rows.into_iter();
    each.flat_map(|row| std::iter::repeat_n(row, times.max(1)))
        .collect()
}

/// The runs of the design of a model in a box, and those of its inputs, with the coarsest grains; parameters that are not active at
/// their start. Of finer grains a plane is sampled, so that the trend with the size is known all over the box.
pub(crate) fn design_runs(
    asked: Asked<'_>,
    first_seed: u64,
    (model, active): (usize, &[usize]),
    region: &Region,
) -> Result<Vec<Wanted>, Error> {
    let parameters = &asked.problem.parameters;
    let symbols = asked.problem.symbols(active);
    let design = surface_design(&symbols, asked.settings)?;
    let mut points = placed(&design.rows, active, region, parameters);
    let middle = placed(&[vec![0.0; active.len()]], active, region, parameters);
    let moved = middle.iter().flat_map(|at| input_points(asked, model, at));
    let times = asked.settings.replicates.max(1);
    points.extend(moved.flat_map(|at| std::iter::repeat_n(at, times)));
    let factors = asked.problem.factors_of(model);
    let mut runs = wanted(first_seed, (model, factors[0]), &points);
    for &finer in &factors[1..] {
        let rows = if active.is_empty() {
            vec![Vec::new(); FINER_AT_A_POINT]
        } else {
            slope_design(&symbols, asked.settings.seed)?
        };
        let points = placed(&rows, active, region, parameters);
        let points = points.into_iter();
        let points: Vec<_> = points
            .flat_map(|at| std::iter::repeat_n(at, times))
            .collect();
        let seed = first_seed + runs.len() as u64;
        runs.extend(wanted(seed, (model, finer), &points));
    }
    Ok(runs)
}

/// Points that show how a model depends on its inputs: `at` with one of them at each end of its range.
pub(crate) fn input_points(asked: Asked<'_>, model: usize, at: &[f64]) -> Vec<Vec<f64>> {
    let moved = |j: usize| {
        let parameter = &asked.problem.parameters[j];
        let ends = parameter.range.into_iter();
        let ends = ends.filter(|end| *end != parameter.start);
        ends.map(move |end| {
            let mut at = at.to_vec();
            at[j] = end;
            at
        })
    };
    let inputs = asked.problem.inputs_of(model).into_iter();
    inputs.flat_map(moved).collect()
}

/// Coded rows as points of all parameters.
pub(crate) fn placed(
    rows: &[Vec<f64>],
    active: &[usize],
    region: &Region,
    parameters: &[crate::Parameter],
) -> Vec<Vec<f64>> {
    let start: Vec<f64> = parameters.iter().map(|p| p.start).collect();
    let point = |row: &Vec<f64>| {
        let mut at = start.clone();
        for (&j, x) in active.iter().zip(row) {
            at[j] = region.natural(j, *x);
        }
        at
    };
    rows.iter().map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::{slope_design, surface_design};
    use crate::{LoopSettings, SurfaceDesign};
    use nalgebra::DMatrix;
    use response_surface::Model;

    fn symbols(n: usize) -> Vec<String> {
        (0..n).map(|i| format!("x{i}")).collect()
    }

    /// Each number of parameters that can be calibrated has a design with more runs than its quadratic has terms, so
    /// that the noise can be estimated.
    #[test]
    fn each_number_of_parameters_has_a_design_that_tells_the_noise() {
        let settings = LoopSettings::default();
        for n in 1..=12 {
            let design = surface_design(&symbols(n), &settings).unwrap();
            let factors = super::coded_factors(&symbols(n)).unwrap();
            let terms = Model::quadratic(&factors).unwrap().terms().len();
            let runs = design.rows.len();
            assert!(runs > terms, "{n} parameters: {runs} runs, {terms} terms");
            let names = [
                "five levels",
                "central composite",
                "Box-Behnken",
                "Latin hypercube",
            ];
            let expected = names[match n {
                1 => 0,
                2 => 1,
                3..=7 => 2,
                _ => 3,
            }];
            assert_eq!(design.name, expected, "{n} parameters");
        }
    }

    /// The slopes of a plane come out of the design and three runs of its middle with a variance below half of that of a
    /// run; a saturated design whose columns all but coincide would give more. With four parameters: five runs of eight.
    #[test]
    fn few_runs_tell_all_slopes() {
        for n in 1..=12 {
            let rows = slope_design(&symbols(n), 1).unwrap();
            assert_eq!(rows.len(), (n + 1).max(4), "{n} parameters");
            let all = rows.len() + 3;
            let x = DMatrix::from_fn(all, n + 1, |i, j| match (rows.get(i), j) {
                (_, 0) => 1.0,
                (Some(row), j) => row[j - 1],
                (None, _) => 0.0,
            });
            let inverse = x
                .tr_mul(&x)
                .try_inverse()
                .expect("all slopes are identifiable");
            for j in 1..=n {
                assert!(inverse[(j, j)] < 0.5, "{n} parameters: {}", inverse[(j, j)]);
            }
        }
    }

    #[test]
    fn a_design_that_does_not_take_so_many_parameters_is_an_error() {
        let settings = LoopSettings {
            surface: SurfaceDesign::BoxBehnken,
            ..LoopSettings::default()
        };
        let error = surface_design(&symbols(2), &settings).unwrap_err();
        assert!(error.to_string().contains("Box-Behnken"), "{error}");
    }
}
