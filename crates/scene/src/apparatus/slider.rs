//! A sled of glued seeds that is pulled over a plate: static friction.

use super::BenchTest;
use super::device::Device;
use crate::Error;
use serde::{Deserialize, Serialize};

/// A sled of glued seeds that is pulled over a plate: static friction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Slider {
    /// Material of the plate; the material of the seed itself means a plate covered with glued seeds.
    pub plate: String,
    /// Name of the kind of seed; the first of the scene if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seed: Option<String>,
    /// Number of pulls.
    #[serde(default = "repeats")]
    pub repeats: usize,
}

/// Number of pulls where the scene states none.
fn repeats() -> usize {
    5
}

impl Device for Slider {
    fn materials(&self) -> Vec<&str> {
        vec![&self.plate]
    }

    fn check(&self) -> Result<(), Error> {
        Ok(())
    }

    fn observables(&self) -> Vec<&str> {
        vec!["shown_static_friction"]
    }

    fn bench_test(&self) -> Option<BenchTest<'_>> {
        Some(BenchTest {
            plate: &self.plate,
            seed: self.seed.as_deref(),
            repeats: self.repeats,
        })
    }
}
