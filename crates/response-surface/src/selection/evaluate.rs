//! What a design can tell before it is run.

use experiment_design::Design;
use probability::random_stream::Stream;
use serde::Serialize;

use crate::fit::least_squares::{LeastSquares, basis, least_squares};
use crate::fit::{Matrix, ratio};
use crate::selection::alias;
use crate::{Error, Model, NamedValues, Observations, Term, Weighting};
use probability::{noncentral_f_upper_tail, t_two_sided_quantile};

/// Random points of the box at which the variance of the prediction is taken.
const POINTS: usize = 4000;

/// Properties of a design for a model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Evaluation {
    /// The model.
    pub model: String,
    /// Number of runs.
    pub runs: usize,
    /// Number of coefficients with the intercept and blocks.
    pub p: usize,
    /// Degrees of freedom of the residuals.
    pub df_resid: usize,
    /// Degrees of freedom of the pure error: runs that repeat earlier settings in their block.
    pub df_pure_error: usize,
    /// Relations of terms that the runs cannot separate; what follows is then none or empty.
    pub aliased: Vec<String>,
    /// Greatest |correlation| of two columns about their means; 0 for an orthogonal design.
    pub greatest_correlation: Option<f64>,
    /// Greatest over least singular value of the scaled columns.
    pub condition: Option<f64>,
    /// Variance inflation factor of each term.
    pub vif: NamedValues<f64>,
    /// Leverage of each run, in its order.
    pub leverage: Vec<f64>,
    /// Efficiencies; none for aliased terms.
    pub efficiency: Option<Efficiency>,
    /// Chance that a term of 1, 2 and 3 standard deviations is found at the 5 % level.
    pub power: NamedValues<[f64; 3]>,
    /// Coefficients of two-factor interactions, squares and products of three that are not in the
    /// model on its terms; none of them if all are zero.
    pub alias: NamedValues<NamedValues<f64>>,
    /// Variance of the prediction over that of a run at shares 0, 0.05, ... 0.95 of the box or region (fraction of design
    /// space), from 4000 random points of the box or those of the region, and the greatest behind them, that of `g_pct`.
    pub variance_by_share: Vec<f64>,
}

/// Efficiencies, %.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Efficiency {
    /// 100 det(X'X)^(1/p) / n.
    pub d_pct: f64,
    /// 100 p / (n trace (X'X)^-1).
    pub a_pct: f64,
    /// 100 p / (n greatest variance), the greatest over the runs, the corners of the box and the random points.
    pub g_pct: f64,
    /// Mean of the variance of the prediction over that of a run: exact over a box, else the mean over the points given.
    pub mean_variance: f64,
}

/// Over which settings predictions are judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Over<'a> {
    /// The box -1 to +1 of all columns; where its variance is taken at random points, they are of this seed.
    Box(u64),
    /// Points that are evenly spread over another region, coded.
    Points(&'a [Vec<f64>]),
}

/// Evaluates a design for a model.
///
/// # Formula
/// Power of a term: `P(F > F_crit)` with noncentrality `beta^2 / C_jj`, `beta = 1/2` per standard
/// deviation for main effects and products (the effect from low to high is 2 beta), `beta = 1` for
/// squares (the effect from the middle to a bound).
///
/// # Source
/// `[Myers2016, chapter 8]`.
///
/// # Errors
/// Those of [`crate::fit_weighted`] but for aliased terms, which are named in the result; [`Error::Length`] for a region
/// without points.
pub fn evaluate(design: &Design, model: &Model, over: Over<'_>) -> Result<Evaluation, Error> {
    let k = design.factors().len();
    if over == Over::Points(&[]) {
        return Err(Error::Length {
            what: "points of the region",
            expected: POINTS,
            given: 0,
        });
    }
    let cells = design.runs().iter().map(|run| crate::Cell {
        block: run.block,
        ..crate::Cell::single(run.coded[..k].to_vec(), 0.0)
    });
    let data = Observations::from_cells(cells.collect())?;
    let matrix = Matrix::unchecked(model, &data, Weighting::Equal)?;
    let (n, p) = (matrix.rows.len(), matrix.names.len());
    let dependent = basis(&matrix.rows, &matrix.names, &matrix.weights).dependent;
    let aliased: Vec<_> = dependent
        .into_iter()
        .map(|(_, relation)| relation)
        .collect();
    let mut evaluation = Evaluation {
        model: model.to_string(),
        runs: n,
        p,
        df_resid: n.saturating_sub(p - aliased.len()),
        df_pure_error: n - crate::fit::same_settings(&data).len(),
        aliased,
        greatest_correlation: greatest_correlation(&matrix),
        condition: None,
        vif: NamedValues::default(),
        leverage: Vec::new(),
        efficiency: None,
        power: NamedValues::default(),
        alias: NamedValues::default(),
        variance_by_share: Vec::new(),
    };
    if !evaluation.aliased.is_empty() || n < p {
        return Ok(evaluation);
    }
    let solved = least_squares(&matrix.rows, &matrix.names, &vec![0.0; n], &matrix.weights)?;
    evaluation.condition = crate::fit::condition(&solved);
    evaluation.vif = crate::fit::variance_inflation(&matrix, &solved);
    evaluation.leverage.clone_from(&solved.leverages);
    let covariance = matrix.model_block(&solved.xtx_inverse);
    let (variances, corners) = variances(model, &covariance, over);
    let all = variances.iter().chain(&corners).chain(&solved.leverages);
    let greatest = all.fold(0.0_f64, |m, v| m.max(*v));
    let mean = match over {
        Over::Box(_) => mean_variance(model, &covariance),
        Over::Points(_) => variances.iter().sum::<f64>() / variances.len() as f64,
    };
    evaluation.efficiency = Some(efficiency(&matrix, &solved, [mean, greatest]));
    let place = |i: usize| ((variances.len() - 1) * i) / 20;
    let shares = (0..20).map(|i| variances[place(i)]);
    evaluation.variance_by_share = shares.chain([greatest]).collect();
    evaluation.power = powers(model, &matrix, &solved.xtx_inverse, n - p);
    evaluation.alias = alias::of_matrix(model, &matrix, &data, &solved.xtx_inverse);
    Ok(evaluation)
}

/// Greatest |correlation| of two columns about their means; none without two columns that vary.
fn greatest_correlation(matrix: &Matrix) -> Option<f64> {
    let n = matrix.rows.len() as f64;
    let centred = |j: usize| -> Vec<f64> {
        let mean = matrix.rows.iter().map(|r| r[j]).sum::<f64>() / n;
        matrix.rows.iter().map(|r| r[j] - mean).collect()
    };
    let columns: Vec<Vec<f64>> = (matrix.first()..matrix.names.len()).map(centred).collect();
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(x, y)| x * y).sum() };
    let mut greatest = None;
    for (i, a) in columns.iter().enumerate() {
        for b in &columns[..i] {
            let correlation = ratio(dot(a, b).abs(), (dot(a, a) * dot(b, b)).sqrt())?;
            greatest = Some(correlation.max(greatest.unwrap_or(0.0)));
        }
    }
    greatest
}

/// Mean over the box of the variance of the prediction over that of a run.
///
/// # Formula
/// `trace(C M)`, C the inverse of X'X and M the moments of the box, the means of the products of two terms over it:
/// a power `x^e` has the mean `1 / (e + 1)` over -1..+1 for even e and 0 for odd e.
///
/// # Source
/// `[Myers2016, chapter 8]`.
fn mean_variance(model: &Model, covariance: &[Vec<f64>]) -> f64 {
    let of_power = |power: u8| match power % 2 {
        0 => 1.0 / f64::from(power + 1),
        _ => 0.0,
    };
    let moment = |a: &Term, b: &Term| -> f64 {
        let powers = a.powers().iter().zip(b.powers());
        powers.map(|(a, b)| of_power(a + b)).product()
    };
    let terms = model.terms().iter();
    let line = |(a, line): (&Term, &Vec<f64>)| -> f64 {
        let pairs = terms.clone().zip(line);
        pairs.map(|(b, c)| c * moment(a, b)).sum()
    };
    terms.clone().zip(covariance).map(line).sum()
}

/// Variances of the prediction at points of the box or region, ascending, and at the corners of the box.
fn variances(model: &Model, covariance: &[Vec<f64>], over: Over<'_>) -> (Vec<f64>, Vec<f64>) {
    let k = model.symbols().len();
    let variance = |x: &Vec<f64>| -> f64 {
        let row = model.row(x);
        let lines = covariance.iter().zip(&row);
        lines
            .map(|(line, a)| a * line.iter().zip(&row).map(|(c, b)| c * b).sum::<f64>())
            .sum()
    };
    let corner = |bits: usize| {
        let end = |j: usize| if bits >> j & 1 == 1 { 1.0 } else { -1.0 };
        (0..k).map(end).collect()
    };
    let (mut variances, corners): (Vec<f64>, usize) = match over {
        Over::Points(points) => (points.iter().map(variance).collect(), 0),
        Over::Box(seed) => {
            let mut stream = Stream::new(seed, "variance over the box");
            let mut point = || -> Vec<f64> { (0..k).map(|_| stream.between(-1.0, 1.0)).collect() };
            let variances = (0..POINTS).map(|_| variance(&point())).collect();
            (variances, if k <= 10 { 1 << k } else { 0 })
        }
    };
    variances.sort_by(f64::total_cmp);
    (
        variances,
        (0..corners).map(|bits| variance(&corner(bits))).collect(),
    )
}

/// Power of each term for 1, 2, 3 standard deviations; empty without residual degrees of freedom.
fn powers(model: &Model, matrix: &Matrix, c: &[Vec<f64>], df: usize) -> NamedValues<[f64; 3]> {
    let Some(limit) = t_two_sided_quantile(0.05, df as f64) else {
        return NamedValues::default();
    };
    let row = |j: usize| {
        let term = &model.terms()[j - matrix.n_blocks];
        let square = term.powers().iter().all(|power| power % 2 == 0);
        let size = if square { 1.0 } else { 0.5 };
        let power = |sigmas: f64| {
            noncentral_f_upper_tail(limit * limit, df as f64, (size * sigmas).powi(2) / c[j][j])
        };
        (
            matrix.names[j].clone(),
            [power(1.0), power(2.0), power(3.0)],
        )
    };
    (matrix.first()..matrix.names.len()).map(row).collect()
}

/// Efficiencies of a design by its matrix and the mean and greatest variance of a prediction, in variances of a run.
fn efficiency(
    matrix: &Matrix,
    solved: &LeastSquares,
    [mean_variance, greatest]: [f64; 2],
) -> Efficiency {
    let (n, p) = (matrix.rows.len(), matrix.names.len());
    let log_of_term = |j: usize| {
        let length: f64 = matrix.rows.iter().map(|r| r[j] * r[j]).sum();
        2.0 * solved.triangle[j][j].abs().ln() + length.ln()
    };
    let log_det: f64 = (0..p).map(log_of_term).sum();
    let trace: f64 = (0..p).map(|j| solved.xtx_inverse[j][j]).sum();
    let (runs, terms) = (n as f64, p as f64);
    Efficiency {
        d_pct: 100.0 * (log_det / terms).exp() / runs,
        a_pct: 100.0 * terms / (runs * trace),
        g_pct: 100.0 * terms / (runs * greatest),
        mean_variance,
    }
}

#[cfg(test)]
mod tests {
    use super::{Over, evaluate};
    use crate::Model;
    use experiment_design::{Factor, box_behnken, full_factorial, plackett_burman};

    fn factors(symbols: &str) -> Vec<Factor> {
        symbols
            .chars()
            .map(|c| Factor::coded_only(&c.to_string()).unwrap())
            .collect()
    }

    /// A full factorial is the best two-level design: orthogonal, VIF 1, all efficiencies 100 %.
    #[test]
    fn a_full_factorial_is_fully_efficient() {
        let f = factors("ABC");
        let design = full_factorial(&f, 0).unwrap();
        let got = evaluate(&design, &Model::linear(&f).unwrap(), Over::Box(1)).unwrap();
        let efficiency = got.efficiency.unwrap();
        for value in [efficiency.d_pct, efficiency.a_pct, efficiency.g_pct] {
            assert!((value - 100.0).abs() < 1e-9, "{value}");
        }
        assert_eq!(got.greatest_correlation, Some(0.0));
        assert!(got.leverage.iter().all(|h| (h - 0.5).abs() < 1e-12));
        // Squares are constant over two levels; nothing else is aliased.
        assert!(
            got.alias
                .iter()
                .all(|(name, parts)| name.ends_with('2') && parts.len() == 1)
        );
        // Mean of (1 + x1^2 + x2^2 + x3^2) / 8 over the box is 2/8; at the corners, where predictions are worst, it is 4/8,
        // and in the middle 1/8.
        assert!((efficiency.mean_variance - 0.25).abs() < 1e-14);
        let points = [vec![1.0, -1.0, 1.0], vec![0.0; 3]];
        let over = Over::Points(&points);
        let got = evaluate(&design, &Model::linear(&f).unwrap(), over).unwrap();
        assert!((got.efficiency.unwrap().mean_variance - 2.5 / 8.0).abs() < 1e-14);
        assert!(evaluate(&design, &Model::linear(&f).unwrap(), Over::Points(&[])).is_err());
    }

    /// The mean variance against the integral of x'Cx over the box by Gauss's rule with three nodes a factor, exact for
    /// the fourth powers of a quadratic (rounding: 1e-12 of the mean).
    #[test]
    fn the_mean_variance_is_the_integral_over_the_box() {
        let f = factors("AB");
        // Without symmetry all moments count.
        let design = experiment_design::latin_hypercube(&f, 12, 1).unwrap();
        let model = Model::quadratic(&f).unwrap();
        let got = evaluate(&design, &model, Over::Box(1)).unwrap();
        let cells = design.coded_rows().into_iter();
        let cells = cells.map(|x| crate::Cell::single(x.clone(), x[0]));
        let data = crate::Observations::from_cells(cells.collect()).unwrap();
        let fit = crate::fit(&f, &model, &data).unwrap();
        let node = 0.6_f64.sqrt();
        let rule = [(-node, 5.0 / 18.0), (0.0, 8.0 / 18.0), (node, 5.0 / 18.0)];
        let each = |(x, u): (f64, f64)| {
            rule.map(|(y, v)| u * v * fit.leverage(&[x, y]))
                .iter()
                .sum::<f64>()
        };
        let integral: f64 = rule.map(each).iter().sum();
        let mean = got.efficiency.unwrap().mean_variance;
        assert!(
            (mean / integral - 1.0).abs() < 1e-12,
            "{mean} against {integral}"
        );
    }

    /// In a Plackett-Burman design of 12 runs interactions alias with +-1/3; a Box-Behnken design
    /// cannot hold a cubic, and says which terms.
    #[test]
    fn aliases_are_reported() {
        let f = factors("ABCDEF");
        let pb = evaluate(
            &plackett_burman(&f).unwrap(),
            &Model::linear(&f).unwrap(),
            Over::Box(1),
        )
        .unwrap();
        let third = pb.alias.get("AB").unwrap().get("C").unwrap().abs();
        assert!((third - 1.0 / 3.0).abs() < 1e-12);
        let f = factors("ABC");
        let cubic = Model::parse("cubic", &f).unwrap();
        let bbd = evaluate(&box_behnken(&f, 5).unwrap(), &cubic, Over::Box(1)).unwrap();
        assert!(
            bbd.aliased
                .iter()
                .any(|relation| relation.starts_with("A3 = A")),
            "{:?}",
            bbd.aliased
        );
        assert!(bbd.efficiency.is_none());
    }
}
