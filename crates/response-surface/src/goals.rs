//! Settings that meet several goals, and the runs that confirm them.

pub(crate) mod confirm;
pub(crate) mod desirability;
pub(crate) mod simplex;
