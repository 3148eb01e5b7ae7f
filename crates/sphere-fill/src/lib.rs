//! From a closed mesh to a body of spheres, with a report of fit.
//!
//! ```
//! use sphere_fill::{FillSettings, InertiaSource, fill};
//! let seed = trimesh::shapes::ellipsoid([2e-3, 1e-3, 1e-3], 12)?;
//! let filling = fill(&seed, &FillSettings { effort: 0.1, ..FillSettings::new(0.4e-3) })?;
//! assert!(filling.report.max_overlap < 1e-3 * 0.4e-3);
//! let body = filling.clump(9.45e-6, InertiaSource::Mesh)?;
//! assert_eq!(body.spheres().len(), filling.spheres.len());
//! # Ok::<(), sphere_fill::Error>(())
//! ```
//!
//! # Packing
//!
//! Spheres that overlap or stand out store the energy
//! E = Σ max(0, 2r − |xᵢ − xⱼ|)² + Σ max(0, φ(xᵢ) + r)², φ the signed distance to the surface.
//! A configuration is a packing when E vanishes, and E is smooth enough to be minimised quickly,
//! so a packing of N + 1 spheres is searched among the minima of E.
//!
//! Invariants of a result of [`Method::Pack`] and [`Method::Lattice`]: overlaps of at most
//! 0.1 % and protrusions of at most 1 % of the radius, measured with the exact distance. The
//! same mesh, settings and seed give the same spheres. No clock is read: work is counted.

mod body;
mod connectivity;
mod count_search;
mod distance_grid;
mod distance_transform;
mod error;
mod favier;
mod ferellec;
mod filling;
mod fit_report;
mod greedy;
mod holes;
mod lattice;
mod near_contacts;
mod near_pairs;
mod neighbours;
mod pack;
mod pack_hops;
mod pack_search;
mod pieces;
mod placement;
mod relaxation;
mod settings;
mod settling;
mod smooth;
mod surface;
mod surface_fit;
mod surface_gap;
mod target;
mod touching;
mod union_moments;
mod union_surface;

pub use body::Body;
pub use connectivity::{Connectivity, SpherePair, neck_radius};
pub use distance_transform::DistanceTransform;
pub use error::Error;
pub use favier::Favier;
pub use ferellec::Ferellec;
pub use filling::{Filling, InertiaSource, Place, fill, measure};
pub use fit_report::FitReport;
pub use lattice::Lattice;
pub use near_contacts::near_pairs_at_contact;
pub use pack::Pack;
pub use settings::{FillSettings, Method};
pub use smooth::Smooth;
pub use surface::Surface;
pub use target::Target;
pub use union_moments::union_moments;
pub use union_surface::union_surface;
