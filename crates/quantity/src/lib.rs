//! Lengths, angles, speeds and other scalars read with their unit and checked.
