//! Coverage of the 95 % contour region over 2000 simulated experiments.
//!
//! Truth: the quadratic of the published study; design: its Box-Behnken design with five replicates,
//! run noise 1.05; target 38.87 measured ten times with noise 0.59. In each experiment a true point
//! of the contour is drawn and it is asked whether the region holds it.

#![expect(clippy::print_stdout, reason = "the table is the result")]

use experiment_design::{Factor, box_behnken};
use probability::random_stream::Stream;
use probability::t_two_sided_quantile;
use response_surface::{ErrorSource, Model, Observations, fit};

const EXPERIMENTS: u64 = 2000;
const TARGET: f64 = 38.87;
const RUN_SD: f64 = 1.05;
const TARGET_SE: f64 = 0.59 / 3.162_277_660_168_379_5;

/// The published surface in coded units.
fn truth(x: &[f64]) -> f64 {
    let [b, e, f] = [x[0], x[1], x[2]];
    36.394 + 1.25 * b - 0.56125 * e + 3.51625 * f + 0.345 * b * e + 0.445 * b * f
        - 0.1125 * e * f
        - 0.51825 * b * b
        + 0.24425 * e * e
        - 0.25075 * f * f
}

/// A point of the true contour: E and B at random, F by bisection if there is one.
fn contour_point(stream: &mut Stream) -> Vec<f64> {
    loop {
        let (b, e) = (stream.between(-1.0, 1.0), stream.between(-1.0, 1.0));
        let (mut low, mut high) = (-1.0, 1.0);
        if (truth(&[b, e, low]) - TARGET) * (truth(&[b, e, high]) - TARGET) > 0.0 {
            continue;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if truth(&[b, e, middle]) < TARGET {
                low = middle;
            } else {
                high = middle;
            }
        }
        return vec![b, e, 0.5 * (low + high)];
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let factors = [
        Factor::coded_only("B")?,
        Factor::coded_only("E")?,
        Factor::coded_only("F")?,
    ];
    let design = box_behnken(&factors, 5)?.replicated(5)?;
    let model = Model::quadratic(&factors)?;
    println!("{:<14} {:>10} {:>10}", "error", "covered", "share %");
    for (name, source) in [
        ("all repeats", ErrorSource::AllRepeats),
        ("residual", ErrorSource::Residual),
    ] {
        let mut covered = 0;
        for seed in 0..EXPERIMENTS {
            let mut stream = Stream::new(seed, "coverage");
            let noise = |stream: &mut Stream, y: f64| Some(y + RUN_SD * stream.normal());
            let responses: Vec<Option<f64>> = design
                .runs()
                .iter()
                .map(|run| noise(&mut stream, truth(&run.coded)))
                .collect();
            let data = Observations::from_design(&design, &responses)?;
            let fitted = fit(&factors, &model, &data)?;
            let point = contour_point(&mut stream);
            let measured = TARGET + TARGET_SE * stream.normal();
            let error = fitted.error_variance(source).ok_or("no error variance")?;
            let limit = t_two_sided_quantile(0.05, error.df as f64).ok_or("no limit")?;
            let variance = error.variance * fitted.leverage(&point) + TARGET_SE * TARGET_SE;
            covered +=
                u64::from((fitted.value(&point) - measured).abs() <= limit * variance.sqrt());
        }
        let share = 100.0 * covered as f64 / EXPERIMENTS as f64;
        println!("{name:<14} {covered:>10} {share:>10.2}");
    }
    println!("nominal 95 %; the share of {EXPERIMENTS} experiments has a standard error of 0.49 %");
    Ok(())
}
