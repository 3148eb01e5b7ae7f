//! Contact search, force loop and time integration of rigid agglomerates.
