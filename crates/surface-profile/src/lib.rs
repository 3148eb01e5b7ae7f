//! The free surface, the definition of its angle, and the uncertainty of that angle.
