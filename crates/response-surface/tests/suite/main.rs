//! Least squares, analysis of variance and solutions against R, NIST, the published study and closed forms.
//!
//! One program for all files: it is linked once, and its tests share the cores.

mod analysis;
mod degenerate;
mod nist;
mod published_study;
mod r;
mod r_blocks;
mod r_comparisons;
mod r_levels;
mod simulated_study;
mod solution_answers;
mod solution_set;
