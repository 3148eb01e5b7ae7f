//! Rough surfaces and slow series for the tests of this crate.

use probability::random_stream::Stream;

/// A stationary sequence with standard deviation 1 and lag correlation `rho^k`.
pub(crate) fn correlated(stream: &mut Stream, n: usize, rho: f64) -> Vec<f64> {
    let mut value = stream.normal();
    let fresh = (1.0 - rho * rho).sqrt();
    (0..n)
        .map(|_| {
            value = rho * value + fresh * stream.normal();
            value
        })
        .collect()
}
