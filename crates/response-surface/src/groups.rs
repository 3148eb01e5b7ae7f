//! Groups and blocks: means, pairs, scatter.

pub(crate) mod one_way;
pub(crate) mod pairs;
pub(crate) mod random_blocks;
pub(crate) mod spread;
