//! The pictures of the report.

pub(crate) mod beds;
pub(crate) mod measurement_charts;
pub(crate) mod photographs;
pub(crate) mod residual_charts;
pub(crate) mod residuals;
pub(crate) mod run_charts;
pub(crate) mod screening_charts;
pub(crate) mod solution_charts;
pub(crate) mod surface_charts;
