//! What one more measurement makes of drawn ties: the one proposed, one by lot, the truly best one.
//!
//! `cargo run --release -p residual-diagnosis --example next_trials -- NUMBER` prints a table in Markdown;
//! `just next-trials` writes it to out/next-trials.md, and what it comes to stands in docs/trials.md.

#![expect(clippy::print_stdout, reason = "the table is the result")]

use inference::diagnosis::{Resolved, next_trials};
use std::error::Error;

/// Seed of all draws.
const SEED: u64 = 1;

fn main() -> Result<(), Box<dyn Error>> {
    let number: usize = std::env::args()
        .nth(1)
        .ok_or("give the number of campaigns")?
        .parse()?;
    let found = next_trials(number, SEED)?;
    println!(
        "{} campaigns, seed {SEED}: {} ties that hold the hidden effect, {} of them without a proposal.\n",
        found.campaigns, found.ties, found.without_proposal
    );
    println!(
        "| measured next | resolved rightly | resolved wrongly | still tied | nothing named |"
    );
    println!("|---|--:|--:|--:|--:|");
    let rows = [
        ("the first one proposed", found.proposed),
        ("one of those on offer, by lot", found.by_lot),
        ("the truly best one", found.best),
    ];
    for (words, resolved) in rows {
        let Resolved {
            rightly,
            wrongly,
            tied,
            unknown,
        } = resolved;
        let percent = |n: usize| format!("{:.1}", 100.0 * n as f64 / found.ties.max(1) as f64);
        println!(
            "| {words} | {} |",
            [rightly, wrongly, tied, unknown].map(percent).join(" | ")
        );
    }
    Ok(())
}
