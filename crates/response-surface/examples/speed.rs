//! Time of a quadratic analysis of 10 000 runs and 10 factors.

#![expect(clippy::print_stdout, reason = "the time is the result")]

use std::time::Instant;

use experiment_design::{Factor, latin_hypercube};
use probability::random_stream::Stream;
use response_surface::{Cell, Model, Observations, fit};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let factors: Vec<Factor> = (0..10)
        .map(|i| Factor::coded_only(&format!("x{i}")))
        .collect::<Result<_, _>>()?;
    let mut stream = Stream::new(1, "speed");
    let mut rows = Vec::new();
    for seed in 0..5 {
        rows.extend(latin_hypercube(&factors, 2000, seed)?.coded_rows());
    }
    let cells: Vec<Cell> = rows
        .into_iter()
        .map(|x| {
            let y = x.iter().sum::<f64>() + x[0] * x[1] + stream.normal();
            Cell::single(x, y)
        })
        .collect();
    let model = Model::quadratic(&factors)?;
    let mut times = Vec::new();
    for _ in 0..5 {
        let start = Instant::now();
        let data = Observations::from_cells(cells.clone())?;
        let fitted = fit(&factors, &model, &data)?;
        times.push(start.elapsed().as_secs_f64());
        assert_eq!(fitted.terms.len(), 66);
    }
    times.sort_by(f64::total_cmp);
    println!(
        "10000 runs, 10 factors, 66 terms: median of 5 {:.3} s",
        times[2]
    );
    Ok(())
}
