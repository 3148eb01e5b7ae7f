//! Smoothness of the sphere filling: the model's seeds may be rougher than real ones.

use crate::effects::{Effect, Entry, Error};
use input::quantity::Length;
use scene::{FillingLibrary, FillingSettings, Scene};
use sphere_fill::Method;

/// Longest time step of a smooth filling, as a share of the duration of a hard contact: two smooth
/// seeds touch at more spheres at a time, which makes their contact stiffer (docs/time-step.md).
const STEP_SHARE: f64 = 0.30;

/// A filling whose surface follows the mesh more closely, with the mass and inertia of the seed.
pub(crate) const EFFECT: Effect = Effect {
    name: "filling-smoothness",
    physics: "A seed packed with equal spheres has a surface of bumps and gaps that lock \
              into each other. A real coated seed is smooth, so the model needs a lower \
              friction coefficient than the bench measures.",
    formula: "roughness = (1 - amplitude) x root mean square roughness of the filling in \
              the scene, reached by overlapping spheres that follow the surface",
    unit: "1",
    source: "CottonStudy",
    range: [0.0, 0.9],
    probe: 0.6,
    entry: Entry::SeedShape,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, fillings: &FillingLibrary) -> Result<(), Error> {
    let roughness = scene
        .seed
        .iter()
        .map(|seed| {
            let body = fillings.body(scene, seed)?;
            let shape = body.shape.as_ref();
            Ok(shape.map_or(0.0, |shape| shape.report.roughness_rms))
        })
        .collect::<Result<Vec<f64>, scene::Error>>()?;
    let refused = |e: input::quantity::Error| Error::Setting {
        name: EFFECT.name,
        reason: e.to_string(),
    };
    for (seed, roughness) in scene.seed.iter_mut().zip(roughness) {
        let target = Length::from_si((1.0 - amplitude) * roughness).map_err(refused)?;
        let Some(filling) = seed.filling().map_err(refused)? else {
            return Err(Error::Setting {
                name: EFFECT.name,
                reason: if seed.spheres.is_some() {
                    format!(
                        "seed '{}' is a table of spheres, which fill no other shape",
                        seed.name
                    )
                } else {
                    format!(
                        "seed '{}' is one sphere, which is smooth already",
                        seed.name
                    )
                },
            });
        };
        seed.filling = Some(FillingSettings {
            method: Method::Smooth,
            sphere_count: None,
            roughness: Some(target),
            ..filling
        });
    }
    let protocol = &mut scene.protocol;
    if protocol.step_share > STEP_SHARE {
        // A fixed step was chosen for rougher seeds.
        protocol.time_step = None;
    }
    protocol.step_share = protocol.step_share.min(STEP_SHARE);
    protocol.flow_step_share = protocol.flow_step_share.map(|s| s.min(STEP_SHARE));
    Ok(())
}
