//! Prints the worst relative difference from R for each data set of `fixtures/r`.

#![expect(clippy::print_stdout, reason = "the table is the result")]

#[path = "../tests/suite/r/table.rs"]
mod table;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!(
        "{:<12} {:>10} {:>10}  of",
        "data set", "quantities", "worst"
    );
    for row in table::rows()? {
        let worst = row.differences.iter().max_by(|a, b| a.1.total_cmp(&b.1));
        let (quantity, worst) = worst.ok_or("nothing compared")?;
        println!(
            "{:<12} {:>10} {worst:>10.1e}  {quantity}",
            row.name,
            row.differences.len()
        );
    }
    Ok(())
}
