//! Prints the log relative errors on the reference data sets of NIST.

#![expect(clippy::print_stdout, reason = "the table is the result")]

#[path = "../tests/nist/table.rs"]
mod table;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!(
        "{:<10} {:>9} {:>9} {:>9} {:>9}",
        "data set", "estimate", "spread", "resid sd", "R2"
    );
    for row in table::rows()? {
        println!(
            "{:<10} {:>9.1} {:>9.1} {:>9.1} {:>9.1}",
            row.name, row.estimate, row.spread, row.residual_sd, row.r2
        );
    }
    println!(
        "digits of agreement, at most 15; estimate and spread: the worst of the coefficients and"
    );
    println!("of their standard deviations, or F and the sums of squares of groups");
    Ok(())
}
