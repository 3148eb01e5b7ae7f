//! Whether a residual is noise or structure, and which effect explains it.
