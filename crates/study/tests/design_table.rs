//! Design tables: what they ask for, everything that they refuse before any run, and the table of results.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod design_table {
    pub(crate) mod folder;
    pub(crate) mod given;
    pub(crate) mod refused;
    pub(crate) mod results;
}
