//! From a closed mesh to a body of spheres, with a report of fit.
