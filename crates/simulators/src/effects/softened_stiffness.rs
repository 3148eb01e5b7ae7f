//! Stiffness of the seeds: lower than that of real ones.

use crate::effects::{Effect, Entry, Error, refused};
use scene::{FillingLibrary, Scene};

/// A lower modulus of every seed material.
pub(crate) const EFFECT: Effect = Effect {
    name: "softened-stiffness",
    physics: "Models are often made softer to save time steps. Contacts then last longer \
              and overlap more, several at once carry a seed, and the bed is denser. The \
              real seeds may also be softer than the declared ones, by moisture.",
    formula: "G = G_declared x 10^(-amplitude), for the material of every seed; overlap \
              at a given load ~ G^(-2/3)",
    unit: "decades",
    source: "Lommen2014",
    range: [0.0, 2.0],
    probe: 1.0,
    entry: Entry::Contact,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    let soft: Vec<String> = scene.seed.iter().map(|s| s.material.clone()).collect();
    let factor = 10_f64.powf(-amplitude);
    for (name, material) in &mut scene.material {
        if soft.contains(name) {
            *material = material
                .stiffened(factor)
                .map_err(|e| refused(EFFECT.name, &e))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::effects::{apply, tests::small_drum};
    use scene::FillingLibrary;

    /// One decade: the seeds have a tenth of `4.01 MPa`, the walls stay as they are. Rounding only.
    #[test]
    fn the_seeds_alone_are_softer_by_the_decades() {
        let mut scene = small_drum();
        apply(
            &mut scene,
            "softened-stiffness",
            1.0,
            &FillingLibrary::default(),
        )
        .unwrap();
        let soft = scene.material["seed"].shear_modulus_pa();
        assert!((soft / 4.01e5 - 1.0).abs() < 1e-12, "{soft}");
        assert_eq!(
            scene.material["tough_resin"],
            small_drum().material["tough_resin"]
        );
    }
}
