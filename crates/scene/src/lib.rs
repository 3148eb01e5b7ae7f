//! Apparatus and protocol: from a scene to observables.
