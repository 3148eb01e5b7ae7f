//! Model matrix, least squares, analysis of variance, the set of solutions.
