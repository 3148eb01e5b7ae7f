//! Factors, coded and natural variables, and designs of experiments.
