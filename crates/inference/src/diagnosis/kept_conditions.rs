//! What conditions that no fit has used say of an effect against an unknown one.

use crate::diagnosis::Error;
use crate::diagnosis::bayes_factor::{ln_factor_of_effect, ln_factor_of_unknown_in};
use crate::diagnosis::covariance::Covariance;
use crate::diagnosis::fit::Fit;
use crate::diagnosis::problem::{Problem, Row};
use crate::diagnosis::problem_file::Condition;
use crate::diagnosis::smooth_basis::basis;
use nalgebra::{DMatrix, DVector};

/// A condition that no fit has used, by real runs of the model without effects and of the one with an effect.
#[derive(Debug, Clone, PartialEq)]
pub struct KeptCondition {
    /// Its coordinates.
    pub condition: Condition,
    /// For each value the number of its observable in the problem.
    pub observables: Vec<usize>,
    /// Covariance of measurement and runs, (values, values).
    pub covariance: DMatrix<f64>,
    /// Observed minus simulated without effects, in the units of the observables.
    pub without: Vec<f64>,
    /// The same with the effect.
    pub with: Vec<f64>,
}

/// ln of the Bayes factor of an effect over an unknown smooth one, by the conditions of the fit and by those kept from it.
///
/// # Formula
///
/// That of the effect is its factor at the conditions of the fit times N(a; 0, V) / N(b; 0, V) at the kept ones: a is what its runs
/// leave there, b what those without it leave. An unknown effect promises nothing there but smoothness: with the basis W over all
/// conditions, whitened, and what re-tuning absorbs taken off in the rows of the fit, (r, b) ~ N(0, Q + k W W'), averaged over k as at
/// the conditions of the fit alone. Thus an effect that is right at values it has not seen is favoured by what a free effect
/// would have had to be lucky for. [own; the evidence of Gaussian linear models]
///
/// # Errors
///
/// [`Error::NotPositiveDefinite`] if a covariance cannot be factorised.
pub fn ln_over_unknown(
    problem: &Problem,
    effect: &str,
    kept: &[KeptCondition],
) -> Result<f64, Error> {
    let names = &problem.candidates;
    let Some(j) = names.iter().position(|c| c.name == effect) else {
        return Ok(f64::NEG_INFINITY);
    };
    let nominal = Fit::new(problem, &[])?;
    let reference = nominal.freed_as(problem, &Fit::new(problem, &[j])?)?;
    let gain = reference.score(j, &names[j]).map_or(0.0, |s| s.gain);
    let [without, with] = [0, 1].map(|which| {
        let all = kept.iter().flat_map(|c| [&c.without, &c.with][which]);
        DVector::from_iterator(kept.iter().map(|c| c.observables.len()).sum(), all.copied())
    });
    let blocks = kept.iter().map(|c| c.covariance.clone()).collect();
    let labels = vec!["a condition kept from the fit".to_owned(); kept.len()];
    let covariance = Covariance::new(blocks, labels);
    let whitener = covariance.whitener()?;
    let white = |values: &DVector<f64>| {
        let column = DMatrix::from_column_slice(values.len(), 1, values.as_slice());
        whitener.whiten(&column).column(0).into_owned()
    };
    let (without, with) = (white(&without), white(&with));
    let own = ln_factor_of_effect(gain, names[j].sign)
        + 0.5 * (without.norm_squared() - with.norm_squared());

    let used = &problem.used;
    let first = used.conditions.len();
    let conditions: Vec<&Condition> = used
        .conditions
        .iter()
        .chain(kept.iter().map(|c| &c.condition))
        .collect();
    let rows_of_kept = kept.iter().zip(first..).flat_map(|(c, condition)| {
        let row = move |&observable: &usize| Row {
            condition,
            observable,
        };
        c.observables.iter().map(row)
    });
    let rows: Vec<Row> = used.rows.iter().copied().chain(rows_of_kept).collect();
    let variances = [used.covariance.diagonal(), covariance.diagonal()].concat();
    let noise: Vec<f64> = variances.iter().map(|v| v.sqrt()).collect();
    let whole = basis(&conditions, &rows, &noise);
    let n = used.rows.len();
    let of_fit = reference.outside_of(&whole.rows(0, n).into_owned());
    let of_kept = whitener.whiten(&whole.rows(n, rows.len() - n).into_owned());
    let remaining = reference.remaining();
    let columns = stacked(&of_fit, &of_kept);
    let residual = DVector::from_iterator(
        remaining.len() + without.len(),
        remaining.iter().chain(without.iter()).copied(),
    );
    let unknown = ln_factor_of_unknown_in(&columns, &residual, of_fit.norm_squared());
    Ok(own - unknown)
}

/// Rows of one matrix over those of another of as many columns.
fn stacked(above: &DMatrix<f64>, below: &DMatrix<f64>) -> DMatrix<f64> {
    let n = above.nrows();
    let at = |i: usize, k: usize| {
        if i < n {
            above[(i, k)]
        } else {
            below[(i - n, k)]
        }
    };
    DMatrix::from_fn(n + below.nrows(), above.ncols(), at)
}

#[cfg(test)]
mod tests {
    use super::{KeptCondition, ln_over_unknown};
    use crate::diagnosis::decision::LN_FACTOR_TO_NAME;
    use crate::diagnosis::{
        Condition, CovarianceInput, Options, Problem, ProblemFile, Verdict, diagnose,
    };
    use nalgebra::DMatrix;

    /// Two values at one condition, 10 standard deviations off, and an effect that lifts all three observables alike. No parameter.
    fn problem() -> Problem {
        let half: Vec<Vec<f64>> = (0..3)
            .map(|i| (0..3).map(|k| if i == k { 0.5 } else { 0.0 }).collect())
            .collect();
        let file = ProblemFile {
            conditions: vec![Condition::default()],
            observables: vec!["a".into(), "b".into(), "c".into()],
            residual_obs_minus_sim: vec![Some(10.0), Some(10.0), None],
            cov_measurement: Some(CovarianceInput::Matrix(half.clone())),
            cov_simulator: Some(CovarianceInput::Matrix(half)),
            sensitivities_declared: vec![Vec::new(); 3],
            library: vec!["lift".into()],
            sensitivities_library: vec![vec![1.0]; 3],
            ..ProblemFile::default()
        };
        Problem::try_from(file).unwrap()
    }

    /// A kept condition where observable c is so far off, without the effect and with it.
    fn kept(without: f64, with: f64) -> KeptCondition {
        KeptCondition {
            condition: Condition::default(),
            observables: vec![2],
            covariance: DMatrix::identity(1, 1),
            without: vec![without],
            with: vec![with],
        }
    }

    /// An unknown effect lifts two values as well as one of the library, which is favoured for its one amplitude alone, and not by odds
    /// of 100. A third value tells: where the effect leaves nothing of 10, an unknown one has the density of N(0, 1 + 50) at 10 at best, a
    /// factor of e^(-0.5 ln 51 - 0.5 100 / 51) = e^-2.95 below that of the effect; the smaller sizes of its prior change that by less
    /// than 0.5. Where the effect does not lift it that far it is not favoured.
    #[test]
    fn a_value_that_no_fit_has_seen_tells_an_effect_from_an_unknown_one() {
        let problem = problem();
        let diagnosis = diagnose(&problem, &Options::new(1)).unwrap();
        assert_eq!(diagnosis.verdict, Verdict::Unknown);
        assert_eq!(diagnosis.proposal, [["lift"]]);
        let alone = ln_over_unknown(&problem, "lift", &[]).unwrap();
        let candidate = diagnosis.candidates["lift"].ln_bf_unknown.unwrap();
        assert!((alone - candidate).abs() < 1e-9, "{alone} {candidate}");
        assert!((0.0..4.0).contains(&alone), "{alone}");
        let met = ln_over_unknown(&problem, "lift", &[kept(10.0, 0.0)]).unwrap();
        assert!((met - alone - 2.95).abs() < 0.5, "{met} {alone}");
        assert!(met > LN_FACTOR_TO_NAME && alone < LN_FACTOR_TO_NAME);
        let missed = ln_over_unknown(&problem, "lift", &[kept(10.0, 6.0)]).unwrap();
        assert!(missed < 0.0, "{missed}");
        // Named with the proposal, and taken back where that is no better than an unknown effect.
        let named = diagnosis.with_proposal_named();
        assert_eq!(
            (named.verdict, &named.effects[..]),
            (Verdict::Named, &["lift".to_owned()][..])
        );
        assert_eq!(
            named.clone().against_unknown(Some(met)).verdict,
            Verdict::Named
        );
        let back = named.against_unknown(Some(alone));
        assert_eq!(
            (back.verdict, &back.suspects[..]),
            (Verdict::Unknown, &["lift".to_owned()][..])
        );
    }
}
