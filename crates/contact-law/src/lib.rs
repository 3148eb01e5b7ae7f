//! Contact laws as pure functions with explicit history.
