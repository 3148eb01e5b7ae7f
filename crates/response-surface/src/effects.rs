//! Which factors and interactions act: two-level designs.

pub(crate) mod interaction_search;
pub(crate) mod pareto;
pub(crate) mod saturated;
pub(crate) mod screening;
