//! Reads what the exported deck of a bench left in its folder, and prints the observables as JSON.
//!
//! `read_bench SCENE.toml FOLDER [name=value ...]`: settings of the scene may be changed.

#![expect(clippy::print_stdout, reason = "the result is the purpose")]

use scene::{FillingLibrary, Override, Scene, starting_frame};
use simulators::exchange::bench_results;
use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let usage = "usage: read_bench SCENE.toml FOLDER [name=value ...]";
    let mut arguments = std::env::args().skip(1);
    let scene = arguments.next().ok_or(usage)?;
    let folder = arguments.next().ok_or(usage)?;
    let change = |text: String| -> Result<Override, Box<dyn Error>> {
        let (name, value) = text.split_once('=').ok_or(usage)?;
        let (name, value) = (name.to_owned(), value.to_owned());
        Ok(Override { name, value })
    };
    let changes: Result<Vec<_>, _> = arguments.map(change).collect();
    let scene = Scene::read(Path::new(&scene), &changes?)?;
    let (_, bodies, time_step) = starting_frame(&scene, &FillingLibrary::default(), 1)?;
    let read = bench_results::read(&scene, &bodies, time_step, Path::new(&folder))?;
    let values: BTreeMap<_, _> = read
        .iter()
        .map(|o| (o.name.to_string(), &o.values))
        .collect();
    println!("{}", serde_json::to_string(&values)?);
    Ok(())
}
