//! Reads positions that another code left of a scene, and prints the observables as JSON.
//!
//! `read_positions SCENE.toml INTERVAL_S FILE [name=value ...]`: the moments of FILE are `INTERVAL_S` apart; settings of the
//! scene may be changed.

#![expect(clippy::print_stdout, reason = "the result is the purpose")]

use scene::{Override, Scene};
use simulators::exchange::read_positions;
use simulators::external_simulator::read_scene;
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let usage = "usage: read_positions SCENE.toml INTERVAL_S FILE [name=value ...]";
    let mut arguments = std::env::args().skip(1);
    let scene = arguments.next().ok_or(usage)?;
    let interval: f64 = arguments.next().ok_or(usage)?.parse()?;
    let file = arguments.next().ok_or(usage)?;
    let change = |text: String| -> Result<Override, Box<dyn Error>> {
        let (name, value) = text.split_once('=').ok_or(usage)?;
        let (name, value) = (name.to_owned(), value.to_owned());
        Ok(Override { name, value })
    };
    let changes: Result<Vec<_>, _> = arguments.map(change).collect();
    let scene = Scene::read(Path::new(&scene), &changes?)?;
    let moments = read_positions(Path::new(&file))?;
    let observables = read_scene(&scene, moments, interval)?;
    println!("{}", serde_json::to_string(&observables)?);
    Ok(())
}
