//! Which terms a model should have: before the runs and behind them.

pub(crate) mod alias;
pub(crate) mod box_cox;
pub(crate) mod evaluate;
pub(crate) mod orders;
pub(crate) mod reduce;
