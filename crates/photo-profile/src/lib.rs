//! From a photo or a rendered frame to the free surface in it.
