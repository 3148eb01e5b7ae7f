//! A seed that falls on a plate and comes back: restitution.

use super::BenchTest;
use super::device::Device;
use crate::Error;
use input::quantity::Length;
use serde::{Deserialize, Serialize};

/// A seed that falls on a plate and comes back: restitution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drop {
    /// Material of the plate; the material of the seed itself means a plate covered with glued seeds.
    pub plate: String,
    /// Name of the kind of seed; the first of the scene if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seed: Option<String>,
    /// Number of drops.
    #[serde(default = "repeats")]
    pub repeats: usize,
    /// Height from which the seed falls until it first touches the plate.
    pub height: Length,
    /// Mass of the seed over that of a plate of glued seeds, which gives way on its tape and comes back slowly; 0, a rigid plate, where
    /// absent.
    #[serde(default)]
    pub plate_give: f64,
}

/// Number of drops where the scene states none.
fn repeats() -> usize {
    40
}

impl Device for Drop {
    fn materials(&self) -> Vec<&str> {
        vec![&self.plate]
    }

    fn check(&self) -> Result<(), Error> {
        super::heap::check_size("apparatus.height", self.height)
    }

    fn observables(&self) -> Vec<&str> {
        vec!["shown_restitution"]
    }

    fn bench_test(&self) -> Option<BenchTest<'_>> {
        Some(BenchTest {
            plate: &self.plate,
            seed: self.seed.as_deref(),
            repeats: self.repeats,
        })
    }
}
