//! The simulator seen from outside, and lists of its runs done in parallel, once each.
