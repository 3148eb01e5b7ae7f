//! Physical and camera effects that a model may lack.
