//! Random numbers for the tests of this crate, which depends on no other of the workspace.

/// The splittable counter hash of `[Steele2014]`.
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    /// A number in [0, 1).
    pub(crate) fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A standard normal number.
    pub(crate) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }

    /// A stationary sequence with standard deviation 1 and lag correlation `rho^k`.
    pub(crate) fn correlated(&mut self, n: usize, rho: f64) -> Vec<f64> {
        let mut value = self.normal();
        let fresh = (1.0 - rho * rho).sqrt();
        (0..n)
            .map(|_| {
                value = rho * value + fresh * self.normal();
                value
            })
            .collect()
    }
}
