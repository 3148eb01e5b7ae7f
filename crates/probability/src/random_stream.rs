//! Random streams that depend only on a seed and a purpose.
//!
//! Two parts of a program that draw from streams of different purposes cannot disturb each
//! other, and a stream gives the same numbers on any machine and for any number of threads.
//!
//! ```
//! use probability::random_stream::Stream;
//! let mut filling = Stream::new(7, "filling");
//! let mut noise = Stream::new(7, "noise");
//! assert_ne!(filling.uniform(), noise.uniform());
//! assert_eq!(Stream::new(7, "noise").uniform(), Stream::new(7, "noise").uniform());
//! ```

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sha2::{Digest, Sha256};

/// A stream of random numbers.
#[derive(Debug, Clone)]
pub struct Stream {
    /// The generator: counter based, with a period longer than any use.
    generator: ChaCha8Rng,
}

impl Stream {
    /// Starts the stream that belongs to `seed` and `purpose`.
    ///
    /// The key of the generator is SHA-256 of both, so near seeds give unrelated streams.
    pub fn new(seed: u64, purpose: &str) -> Self {
        let mut hash = Sha256::new();
        hash.update(seed.to_le_bytes());
        hash.update(purpose.as_bytes());
        Self {
            generator: ChaCha8Rng::from_seed(hash.finalize().into()),
        }
    }

    /// Returns the next 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.generator.next_u64()
    }

    /// Returns a number in [0, 1), uniform, with 53 random bits.
    pub fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }

    /// Returns a number in [low, high), uniform.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Returns an index in 0..n, uniform to within n / 2^64; 0 for n = 0.
    pub fn below(&mut self, n: usize) -> usize {
        let wide = u128::from(self.bits()) * n as u128;
        usize::try_from(wide >> 64).unwrap_or(0)
    }

    /// Returns a standard normal number (Box and Muller, 1958).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }

    /// Returns a unit quaternion (w, x, y, z), uniform over rotations (Shoemake, 1992).
    pub fn rotation(&mut self) -> [f64; 4] {
        let (u, a, b) = (
            self.uniform(),
            std::f64::consts::TAU * self.uniform(),
            std::f64::consts::TAU * self.uniform(),
        );
        let (p, q) = ((1.0 - u).sqrt(), u.sqrt());
        [p * a.sin(), p * a.cos(), q * b.sin(), q * b.cos()]
    }

    /// Puts the items in random order (Fisher and Yates).
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, self.below(i + 1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Stream;

    /// Mean and variance of n draws lie within four standard errors of their expectations:
    /// a right generator fails this once in 16 000 seeds, and the seed is fixed.
    #[test]
    fn normal_numbers_have_mean_zero_and_variance_one() {
        let mut stream = Stream::new(1, "normal");
        let n = 100_000;
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..n {
            let x = stream.normal();
            sum += x;
            squares += x * x;
        }
        let n = f64::from(n);
        assert!((sum / n).abs() < 4.0 / n.sqrt(), "mean {}", sum / n);
        assert!(
            (squares / n - 1.0).abs() < 4.0 * (2.0 / n).sqrt(),
            "variance {}",
            squares / n
        );
    }

    #[test]
    fn index_stays_in_range_and_reaches_both_ends() {
        let mut stream = Stream::new(2, "below");
        let drawn: Vec<usize> = (0..1000).map(|_| stream.below(3)).collect();
        assert!(drawn.iter().all(|&i| i < 3), "an index is out of range");
        assert!((0..3).all(|i| drawn.contains(&i)), "an index never comes");
    }

    #[test]
    fn rotation_is_a_unit_quaternion() {
        let mut stream = Stream::new(3, "rotation");
        for _ in 0..100 {
            let norm: f64 = stream.rotation().iter().map(|c| c * c).sum();
            assert!((norm - 1.0).abs() < 1e-14, "norm {norm}");
        }
    }
}
