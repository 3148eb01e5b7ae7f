//! Scenes, other codes and any program as simulators, the effects that a model may lack, and the formats of other tools.

pub mod effects;
pub mod exchange;
pub mod external_simulator;
pub mod scene_simulator;
