//! Information on tuned parameters beside inputs whose errors are known, in widths of the limits.

use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};

/// Information of an even spread over the limits, in 1 / widths²: the variance of that is 1/12.
const EVEN_SPREAD: f64 = 12.0;
/// Information along a combination, over the largest of a parameter, below which there is none.
const IMITATED: f64 = 1e-12;

/// The information on the tuned parameters, which come first, if of the inputs behind them only the priors are known.
///
/// # Formula
///
/// `M_tt - M_ti M_ii^-1 M_it`, the complement of Schur.
pub(crate) fn without_inputs(information: &DMatrix<f64>, tuned: usize) -> DMatrix<f64> {
    let inputs = information.nrows() - tuned;
    let own = information.view((0, 0), (tuned, tuned)).into_owned();
    let across = information.view((tuned, 0), (inputs, tuned)).into_owned();
    let of_inputs = information.view((tuned, tuned), (inputs, inputs));
    // The prior of each input is in it, so that it has a root.
    match Cholesky::new(of_inputs.into_owned()) {
        Some(root) if inputs > 0 => own - across.tr_mul(&root.solve(&across)),
        _ => own,
    }
}

/// An information matrix without what the noise of the slopes along the inputs, which come last, adds to it; `precisions` are those of
/// their priors.
///
/// # Formula
///
/// `M_ii = M_it M_tt^-1 M_ti + E + P`: the first part is that of slopes along inputs which those along tuned parameters imitate, P the
/// priors, and E what is left, by which the two are distinguished. Noise alone gives E on average N, so that `E - N` stays, or nothing.
pub(crate) fn with_noisy_inputs(
    information: &DMatrix<f64>,
    noise: &DMatrix<f64>,
    precisions: &[f64],
) -> DMatrix<f64> {
    let inputs = noise.nrows();
    let tuned = information.nrows() - inputs;
    let mut corrected = information.clone();
    if inputs == 0 {
        return corrected;
    }
    let priors = DMatrix::from_diagonal(&DVector::from_column_slice(precisions));
    let own = information.view((0, 0), (tuned, tuned)).into_owned();
    let across = information.view((0, tuned), (tuned, inputs)).into_owned();
    let of_inputs = information.view((tuned, tuned), (inputs, inputs));
    let least = IMITATED * own.diagonal().amax();
    let inverse = along_directions(&own, |v| if v > least { 1.0 / v } else { 0.0 });
    let imitated = across.tr_mul(&(inverse * &across));
    let apart = of_inputs - &priors - &imitated - noise;
    let apart = along_directions(&apart, |v| v.max(0.0));
    let mut block = corrected.view_mut((tuned, tuned), (inputs, inputs));
    block.copy_from(&(imitated + apart + priors));
    corrected
}

/// By how much each tuned parameter moves if an input is one standard deviation larger than it was stated and the other inputs are
/// known by their priors only, (tuned, inputs).
///
/// # Formula
///
/// `-M_oo^-1 M_oi / sqrt(P_i)`, M the information on all parameters, o all of them but the input i, P the precisions of the priors.
pub(crate) fn by_inputs(information: &DMatrix<f64>, precisions: &[f64]) -> DMatrix<f64> {
    let inputs = precisions.len();
    let tuned = information.nrows() - inputs;
    let mut moves = DMatrix::zeros(tuned, inputs);
    for (place, precision) in precisions.iter().enumerate() {
        let others = information.clone().remove_row(tuned + place);
        let across = others.column(tuned + place).into_owned();
        let others = bounded_inverse(&others.remove_column(tuned + place));
        let all = others * across / -precision.sqrt();
        moves.set_column(place, &all.rows(0, tuned));
    }
    moves
}

/// The inverse of an information matrix in widths of the limits; along directions of which less is known than the limits
/// say, the variance is that of an even spread over them.
pub(crate) fn bounded_inverse(information: &DMatrix<f64>) -> DMatrix<f64> {
    along_directions(information, |v| 1.0 / v.max(EVEN_SPREAD))
}

/// The information that an even spread over the limits adds to an information matrix along directions of which less is known.
pub(crate) fn spread_added(information: &DMatrix<f64>) -> DMatrix<f64> {
    along_directions(information, |v| (EVEN_SPREAD - v).max(0.0))
}

/// A symmetric matrix with other values along its principal directions.
fn along_directions(matrix: &DMatrix<f64>, value: impl Fn(f64) -> f64) -> DMatrix<f64> {
    let eigen = SymmetricEigen::new(matrix.clone());
    let values = DMatrix::from_diagonal(&eigen.eigenvalues.map(value));
    &eigen.eigenvectors * values * eigen.eigenvectors.transpose()
}

#[cfg(test)]
mod tests {
    use super::{by_inputs, with_noisy_inputs, without_inputs};
    use nalgebra::DMatrix;

    /// A parameter and an input: slopes that tell 40 of the one, 20 of both, and of the other 10, which the parameter imitates, 30 by
    /// which they are distinguished, and 10 from its prior.
    fn information() -> DMatrix<f64> {
        DMatrix::from_row_slice(2, 2, &[40.0, 20.0, 20.0, 50.0])
    }

    /// By hand: 40 - 20²/50 = 32 is left of the parameter. If the input were one standard deviation, 1 / sqrt(10), larger, it would
    /// be 20/40 of that smaller.
    #[test]
    fn an_input_takes_information_and_moves_a_parameter() {
        let left = without_inputs(&information(), 1)[(0, 0)];
        assert!((left - 32.0).abs() < 1e-12, "{left}");
        let moves = by_inputs(&information(), &[10.0])[(0, 0)];
        assert!((moves + 0.5 / 10.0_f64.sqrt()).abs() < 1e-12, "{moves}");
    }

    /// Of the 30 that tell them apart 20 may be noise: 40 - 20²/30. If all of it may be, the variance of the parameter is that of its
    /// own slopes, 1/40, and what the prior of the input leaves, (20/40)²/10: an information of 20.
    #[test]
    fn noise_tells_no_input_from_a_parameter() {
        for (noise, expected) in [(0.0, 32.0), (20.0, 40.0 - 400.0 / 30.0), (99.0, 20.0)] {
            let noise = DMatrix::from_element(1, 1, noise);
            let corrected = with_noisy_inputs(&information(), &noise, &[10.0]);
            let left = without_inputs(&corrected, 1)[(0, 0)];
            assert!((left - expected).abs() < 1e-12, "{left} for {expected}");
        }
    }
}
