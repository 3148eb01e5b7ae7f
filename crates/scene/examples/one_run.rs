//! One run of a scene: `one_run SCENE.toml SEED [FRAME.png] [name=value ...]`.
use scene::{FillingLibrary, Override, Scene, drum_picture, run};
use std::time::Instant;
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let overrides: Vec<Override> = arguments[2..].iter().filter_map(|a| a.split_once('=')).map(|(n, v)| Override { name: n.into(), value: v.into() }).collect();
    let scene = Scene::read(std::path::Path::new(&arguments[0]), &overrides)?;
    let library = FillingLibrary::default();
    let begin = Instant::now();
    for seed in &scene.seed { let b = library.body(&scene, seed)?; println!("{} spheres {} outer {} density {:.1} roughness {:.4} mm", seed.name, b.clump.spheres().len(), b.outer.spheres().len(), b.fraction_density, b.report.roughness_rms*1e3); }
    println!("filling {:.2} s", begin.elapsed().as_secs_f64());
    let begin = Instant::now();
    let result = run(&scene, &library, arguments[1].parse()?)?;
    println!("run {:.1} s, dt {:.3e}, {} steps, {:.0} us/step {:?}", begin.elapsed().as_secs_f64(), result.time_step, result.n_steps, begin.elapsed().as_secs_f64()*1e6/result.n_steps as f64, result.truncation);
    let mut image = Vec::new(); let mut position = Vec::new(); let mut curv = Vec::new();
    for (f, r) in result.frames.iter().zip(&result.readings) {
        let i = r.photo.angle.map(|a| a.line.to_degrees()); let p = r.position.map(|a| a.line.to_degrees());
        println!("{:.2} s image {:?} position {:?} {:?}", f.time, i, p, r.photo.verdict);
        if let Some(i) = i { image.push(i); curv.push(r.photo.angle.unwrap().curvature); } if let Some(p) = p { position.push(p); }
    }
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let slip: Vec<f64> = result.series.iter().map(|p| p.shell_slip).collect();
    let com: Vec<f64> = result.series.iter().map(|p| p.centre_of_mass_deg).collect();
    let start = result.truncation.map_or(0, |t| t.cut);
    println!("image {:.2} position {:.2} curvature {:.3} com {:.2} slip {:.3} {:?} filling {:?}", mean(&image), mean(&position), mean(&curv), mean(&com[start..]), mean(&slip[start..]), result.regime, result.filling_angles.iter().map(|a| a.to_degrees()).collect::<Vec<_>>());
    println!("{:?}", result.census);
    if let Some(path) = arguments.get(2).filter(|a| a.ends_with(".png")) { drum_picture(&scene, &result.bodies, result.frames.last().unwrap())?.save(path)?; }
    Ok(())
}
