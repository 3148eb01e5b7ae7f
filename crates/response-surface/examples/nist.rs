//! Prints the log relative errors on the reference data sets of NIST.

#![expect(clippy::print_stdout, reason = "the table is the result")]

#[path = "../tests/suite/nist/table.rs"]
mod table;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!(
        "{:<10} {:>9} {:>9} {:>9} {:>9} {:>9}",
        "data set", "estimate", "spread", "resid sd", "R2", "stored F"
    );
    for row in table::rows()? {
        println!(
            "{:<10} {:>9.1} {:>9.1} {:>9.1} {:>9.1} {:>9}",
            row.name,
            row.estimate,
            row.spread,
            row.residual_sd,
            row.r2,
            row.stored
                .map_or_else(|| "-".to_owned(), |digits| format!("{digits:.1}"))
        );
    }
    println!(
        "digits of agreement, at most 15; estimate and spread: the worst of the coefficients and"
    );
    println!(
        "of their standard deviations, or F and the sums of squares of groups; stored F: that of"
    );
    println!("groups whose responses were stored as f64 before, instead of read as decimals");
    Ok(())
}
