//! Size of the seeds: other than declared.

use crate::effects::{Effect, Entry, Error};
use scene::{FillingLibrary, Scene};

/// Seeds larger or smaller than their meshes, with the mass that was weighed.
pub(crate) const EFFECT: Effect = Effect {
    name: "seed-size",
    physics: "The scanned seed is one of thousands; the mean size of those in the drum \
              may differ. Larger seeds fill the drum higher and make the drum narrower, \
              counted in seeds. The mass was weighed and stays, and so does the shape.",
    formula: "lengths of every seed = (1 + amplitude) x declared",
    unit: "1",
    source: "CottonStudy",
    range: [-0.15, 0.15],
    probe: 0.08,
    entry: Entry::SeedShape,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    scene.fix_seeds();
    for seed in &mut scene.seed {
        seed.scale = Some(seed.scale.unwrap_or(1.0) * (1.0 + amplitude));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::effects::{apply, tests::small_drum};
    use scene::FillingLibrary;

    /// Lengths 8 % larger: the body reaches 1.08 times as far, with the same mass and number of
    /// spheres, and its volume is 1.08^3 times as large. Rounding only.
    #[test]
    fn the_body_is_similar_to_the_declared_one() {
        let fillings = FillingLibrary::default();
        let (declared, mut larger) = (small_drum(), small_drum());
        apply(&mut larger, "seed-size", 0.08, &fillings).unwrap();
        for (a, b) in declared.seed.iter().zip(&larger.seed) {
            let [a, b] = [(&declared, a), (&larger, b)].map(|(s, k)| fillings.body(s, k).unwrap());
            let reach = b.clump.bounding_radius() / a.clump.bounding_radius();
            assert!((reach - 1.08).abs() < 1e-12, "reach {reach}");
            let volume = (b.volume_radius() / a.volume_radius()).powi(3);
            assert!((volume - 1.08_f64.powi(3)).abs() < 1e-9, "volume {volume}");
            assert_eq!(a.clump.mass(), b.clump.mass());
            assert_eq!(a.clump.spheres().len(), b.clump.spheres().len());
        }
    }
}
