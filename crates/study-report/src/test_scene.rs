//! A drum of spheres, and the record of a run in it, for the tests.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use campaign::run_store::{Observation, Record};
use image::codecs::png::PngEncoder;
use scene::Scene;
use serde_json::json;
use std::path::Path;

/// The text of the scene.
const DRUM: &str = r#"
[apparatus]
kind = "drum"
inner_diameter = "100 mm"
width = "20 mm"
speed = "15 rpm"
shell = "steel"
cover = "steel"

[[seed]]
name = "pea"
mesh = "sphere.stl"
mesh_unit = "mm"
mass = "5.4 mg"
count = 100
material = "pea"
filling = { method = "pack", sphere_radius = "0.99 mm", sphere_count = 1, seed = 1 }

[material.pea]
poisson_ratio = 0.3
shear_modulus = "4 MPa"

[material.steel]
poisson_ratio = 0.3
shear_modulus = "1 GPa"

[contact.pea-pea]
restitution = 0.3
static_friction = 0.3
rolling_friction = 0.0

[contact.pea-steel]
restitution = 0.3
static_friction = 0.3
rolling_friction = 0.0

[model]
dashpot_mass = "sphere"
normal_force_end = "clipped"
bond_number = 0.0
gravity_m_s2 = 9.81

[protocol]
settle_limit = "0.8 s"
rotation_limit = "3 s"
frame_interval = "0.2 s"
frames = 2

[camera]
pixels = 400
roll = "0 deg"
"#;

/// The drum; its mesh lies in the folder.
pub(crate) fn drum(folder: &Path) -> Scene {
    Scene::from_text(DRUM, "drum.toml", folder, &[]).unwrap()
}

/// A frame as PNG.
pub(crate) fn frame() -> Vec<u8> {
    let picture = dev_support::drawn_pictures::Scene::default().draw();
    let mut bytes = Vec::new();
    picture
        .write_with_encoder(PngEncoder::new(&mut bytes))
        .unwrap();
    bytes
}

/// Two peas of 3 mm, one of them turned: kind, place (m), rotation w, x, y, z.
pub(crate) const PEAS: [[f32; 8]; 2] = [
    [0.0, 0.01, -0.04, 0.005, 1.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, -0.045, -0.005, 0.0, 0.0, 1.0, 0.0],
];

/// The peas as a record keeps them.
pub(crate) fn bodies() -> serde_json::Value {
    json!({
        "kinds_base64": [floats(&[0.0, 0.0, 0.0, 0.003])],
        "seeds_base64": floats(PEAS.as_flattened()),
    })
}

/// 32-bit floats as a record keeps them.
fn floats(numbers: &[f32]) -> String {
    let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
    STANDARD.encode(bytes)
}

/// The record of a run in it that kept a frame and a series.
pub(crate) fn record() -> Record {
    let inputs = json!({ "model": "drum-30", "parameters": { "F": 0.33, "E": 0.4 } });
    let angle = Observation {
        mean: 36.25,
        sd: Some(0.4),
        n: 5,
        unit: "deg".into(),
    };
    Record::new("0", inputs, 18_446_744_073_709_551_615)
        .unwrap()
        .with_observable("angle_deg", angle)
        .unwrap()
        .with_details(json!({
            "start_up_s": 0.5,
            "series": {
                "time_s": [0.0, 0.5, 1.0, 1.5],
                "centre_of_mass_deg": [0.0, 30.0, 35.0, 34.0],
            },
            "frames": { "times_s": [1.0, 1.4] },
            "last_frame_png_base64": STANDARD.encode(frame()),
            "last_bodies": bodies(),
        }))
}
