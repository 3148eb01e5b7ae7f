//! The fitted surface: its shape, its predictions and their scatter.

pub(crate) mod canonical;
pub(crate) mod data_region;
pub(crate) mod extremes;
pub(crate) mod natural;
pub(crate) mod prediction;
pub(crate) mod propagation;
pub(crate) mod quadratic;
pub(crate) mod ridge;
pub(crate) mod sobol;
pub(crate) mod tolerance;
pub(crate) mod within;
