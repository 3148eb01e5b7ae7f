//! What a filling costs in a simulation, counted.

use serde::Serialize;
use sphere_fill::near_pairs_at_contact;

/// Cost of a step as a line over the near pairs, relative to a packing of equal spheres: fitted to the fillings of the study's
/// seed in `docs/benchmarks.md` (`python3 trials/filling_cost.py`), which it meets within 14 %.
const LINE: [f64; 2] = [0.9, 0.03];

/// Near pairs of a filling, and the cost that they stand for.
#[derive(Debug, Serialize)]
pub(crate) struct Cost {
    /// Pairs of spheres with a gap of at most 1 % of the size where two seeds touch, on average.
    near_pairs_per_contact: f64,
    /// Cost of a step of a bed over that of a bed of packed seeds.
    relative_step_cost: f64,
}

impl Cost {
    /// Counts the near pairs.
    pub(crate) fn new(spheres: &[geometry::clump::Sphere]) -> Self {
        let near_pairs_per_contact = near_pairs_at_contact(spheres);
        let [first, each] = LINE;
        Self {
            near_pairs_per_contact,
            relative_step_cost: first + each * near_pairs_per_contact,
        }
    }

    /// Names and values for people.
    pub(crate) fn lines(&self) -> Vec<(&'static str, String)> {
        let pairs = format!(
            "{:.2} where two seeds touch (single spheres: 1)",
            self.near_pairs_per_contact
        );
        let step = format!("{:.2} times that of packed seeds", self.relative_step_cost);
        vec![("near pairs of spheres", pairs), ("cost of a step", step)]
    }
}
