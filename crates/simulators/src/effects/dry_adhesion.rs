//! Dry adhesion: surfaces hold each other by their surface energy.

use crate::effects::{Effect, Entry, Error};
use scene::{FillingLibrary, Scene};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// The pull-off force of smooth spheres of the size of a seed, while two surfaces touch.
pub(crate) const EFFECT: Effect = Effect {
    name: "dry-adhesion",
    physics: "Clean dry surfaces attract each other over molecular distances. The force \
              grows with the radius of the seed, and a flat wall holds twice as hard as \
              another seed, which tells it from a liquid or a tacky coat of equal force. \
              The force is the pull-off force of smooth spheres, at any overlap; the \
              wider contact and the stretched neck of the full theory are left out, and \
              roughness lowers the effective work of adhesion.",
    formula: "F = 3/2 pi W R*, 1/R* = 1/R_i + 1/R_j, R of the sphere with the volume of \
              the seed, flat walls 1/R = 0",
    unit: "mJ/m2",
    source: "JohnsonKendallRoberts1971",
    range: [0.0, 100.0],
    probe: 30.0,
    entry: Entry::Contact,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, fillings: &FillingLibrary) -> Result<(), Error> {
    let radii = mean_radii(scene, fillings)?;
    for (pair, contact) in &mut scene.contact {
        let curvature: f64 = pair
            .split('-')
            .filter_map(|name| radii.get(name))
            .map(|radius| 1.0 / radius)
            .sum();
        // Two walls never meet.
        if curvature > 0.0 {
            let pull = 1.5 * PI * 1e-3 * amplitude / curvature;
            contact.attraction_n = Some(contact.attraction_n.unwrap_or(0.0) + pull);
        }
    }
    Ok(())
}

/// Radius of the sphere with the volume of a seed, m, by material: the mean over its seeds.
fn mean_radii(scene: &Scene, fillings: &FillingLibrary) -> Result<BTreeMap<String, f64>, Error> {
    let mut sums: BTreeMap<String, [f64; 2]> = BTreeMap::new();
    for seed in scene.seed.iter().filter(|s| scene.count_of(s) > 0) {
        let radius = fillings.body(scene, seed)?.volume_radius();
        let sum = sums.entry(seed.material.clone()).or_default();
        sum[0] += scene.count_of(seed) as f64 * radius;
        sum[1] += scene.count_of(seed) as f64;
    }
    Ok(sums
        .into_iter()
        .map(|(name, [r, n])| (name, r / n))
        .collect())
}

#[cfg(test)]
mod tests {
    use crate::effects::{apply, tests::small_drum};
    use scene::FillingLibrary;

    /// All seeds of one kind: 3/2 pi W R/2 between seeds and 3/2 pi W R at a wall, W = 50 mJ/m2 and R
    /// from the volume of the mesh. Rounding only.
    #[test]
    fn the_attraction_is_the_pull_off_force() {
        let (mut scene, fillings) = (small_drum(), FillingLibrary::default());
        scene.seed.truncate(1);
        apply(&mut scene, "dry-adhesion", 50.0, &fillings).unwrap();
        let radius = fillings
            .body(&scene, &scene.seed[0])
            .unwrap()
            .volume_radius();
        let whole = 1.5 * std::f64::consts::PI * 0.05 * radius;
        for (pair, expected) in [
            ("seed-seed", 0.5 * whole),
            ("seed-tough_resin", whole),
            ("seed-clear_resin", whole),
        ] {
            let pull = scene.contact[pair].attraction_n.unwrap();
            assert!((pull / expected - 1.0).abs() < 1e-12, "{pair}: {pull} N");
        }
    }
}
