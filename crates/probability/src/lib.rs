//! Distributions of statistics: tails, quantiles, and the functions behind them.
//!
//! Tails come from the incomplete beta and gamma functions themselves, never as 1 - cdf, so that a p value of 1e-28 keeps
//! its digits. Undefined values are `None`. The whole workspace uses these distributions.
//!
//! ```
//! // Student's t with 10 degrees of freedom exceeds 2.2281 either way in one case of twenty.
//! let t = probability::t_two_sided_quantile(0.05, 10.0).unwrap();
//! assert!((t - 2.2281).abs() < 1e-4);
//! assert!((probability::t_two_sided_tail(t, 10.0).unwrap() - 0.05).abs() < 1e-12);
//! ```

mod chi_squared;
mod f;
mod normal;
mod polygamma;
mod quantile_search;
pub mod random_stream;
mod sample;
mod student;
mod studentized_range;

pub use chi_squared::{chi_squared_quantile, chi_squared_upper_tail};
pub use f::{f_quantile, f_upper_tail, noncentral_f_upper_tail};
pub use normal::{
    ln_normal_cdf, normal_cdf, normal_density, normal_quantile, normal_upper_quantile,
};
pub use polygamma::{digamma, inverse_trigamma, trigamma};
pub use sample::{median, quantile};
pub use student::{t_two_sided_quantile, t_two_sided_tail};
pub use studentized_range::{studentized_range_quantile, studentized_range_upper_tail};
