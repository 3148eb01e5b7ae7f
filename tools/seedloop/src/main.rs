//! The seedloop command: thin glue between the command line and the crates.

mod analyse;
mod bench_test;
mod calibrate;
mod design;
mod diagnose;
mod diagnose_problem;
mod diagnose_study;
mod enter;
mod export;
mod init;
mod levels;
mod next_measurement;
mod optimise;
mod passport;
mod read_deck;
mod run;
mod run_flags;
mod running;
mod simulate;
mod stop;
mod verify;

use clap::{Parser, Subcommand};
use command_line::Common;
use std::process::ExitCode;

/// Calibrates the contact parameters of seeds: simulation, designs, surfaces, diagnosis
#[derive(Parser, Debug)]
#[command(
    version,
    propagate_version = true,
    after_help = "Example:\n  seedloop init drum --out my-drum"
)]
struct Cli {
    /// What to do.
    #[command(subcommand)]
    command: Command,
}

/// What the command can do.
#[derive(Subcommand, Debug)]
enum Command {
    /// Runs one scene and prints what it shows
    Simulate(simulate::Arguments),
    /// Writes a design of experiments as a table of runs
    Design(design::Arguments),
    /// Runs every row of a design table and writes the results beside it, ready for `seedloop analyse`
    Run(run::Arguments),
    /// Fits a model to the table of an experiment: coefficients, analysis of variance, diagnostics
    Analyse(analyse::Arguments),
    /// Finds where a fitted surface meets a target: the whole set, its region, the nearest solutions
    Optimise(optimise::Arguments),
    /// Writes a commented study to start from, its scene, and the job script of a cluster
    Init(init::Arguments),
    /// Calibrates the parameters of a study on its measurements: screening, surfaces, solutions, check, diagnosis
    #[command(after_help = calibrate::EXAMPLE)]
    Calibrate {
        /// The study and where its results go.
        #[command(flatten)]
        arguments: calibrate::Arguments,
        /// The flags that every command has.
        #[command(flatten)]
        common: Common,
    },
    /// States which effect, if any, explains a residual that no parameters remove
    Diagnose(diagnose::Arguments),
    /// Reads bench measurements, or does the same test with the solver
    BenchTest(bench_test::Arguments),
    /// Writes a scene as a deck for LAMMPS or LIGGGHTS, a table for EDEM, or its frames for `ParaView`
    Export(export::Arguments),
    /// Reads what the exported deck of a bench left, and prints the observables as `seedloop simulate` does
    ReadDeck(read_deck::Arguments),
    /// Writes parameters with their conventions and a self-test for other codes; or checks what another code gave
    Passport(passport::Arguments),
    /// Checks the solver against mechanics and prints the table
    Verify(verify::Arguments),
}

fn main() -> ExitCode {
    let cli: Cli = command_line::parse();
    command_line::finish(match &cli.command {
        Command::Simulate(arguments) => simulate::run(arguments),
        Command::Design(arguments) => design::run(arguments),
        Command::Run(arguments) => run::run(arguments),
        Command::Analyse(arguments) => analyse::run(arguments),
        Command::Optimise(arguments) => optimise::run(arguments),
        Command::Init(arguments) => init::run(arguments),
        Command::Calibrate { arguments, common } => calibrate::run(arguments, common),
        Command::Diagnose(arguments) => diagnose::run(arguments),
        Command::BenchTest(arguments) => bench_test::run(arguments),
        Command::Export(arguments) => export::run(arguments),
        Command::ReadDeck(arguments) => read_deck::run(arguments),
        Command::Passport(arguments) => passport::run(arguments),
        Command::Verify(arguments) => verify::run(arguments),
    })
}
