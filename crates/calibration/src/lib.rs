//! Screening, response surface, solutions and validation over any simulator.
