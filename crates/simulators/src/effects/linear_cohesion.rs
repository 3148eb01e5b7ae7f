//! Linear cohesion: touching surfaces hold each other by the area over which they touch.

use crate::effects::{Effect, Entry, Error, refused};
use contact_law::linear_cohesion::contact_area;
use contact_law::material;
use scene::{FillingLibrary, Scene, SeedSettings};

/// An attraction in proportion to the area of contact in every contact.
pub(crate) const EFFECT: Effect = Effect {
    name: "linear-cohesion",
    physics: "Soft or sticky surfaces hold each other the more, the harder they are pressed \
              together. Contacts deep in the bed resist sliding more and those of its \
              surface, which carry little, nearly as before: the attraction acts as \
              friction that grows with the load, and holds no seed from below.",
    formula: "F = k A, A = 2 pi R* d; the amplitude is F over the weight of the heaviest \
              seed where two of its kind, as spheres of their volume, are pressed by that \
              weight, and gives k, the cohesion energy density of every contact",
    unit: "1",
    source: "Kloss2012",
    range: [0.0, 3.0],
    probe: 0.6,
    entry: Entry::Contact,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, fillings: &FillingLibrary) -> Result<(), Error> {
    let density = amplitude * density_of_weight(scene, fillings)?;
    for contact in scene.contact.values_mut() {
        let stated = contact.cohesion_energy_density_j_m3.unwrap_or(0.0);
        contact.cohesion_energy_density_j_m3 = Some(stated + density);
    }
    Ok(())
}

/// Weight of the heaviest seed over the area of contact of two of its kind that are pressed by it, J/m³.
fn density_of_weight(scene: &Scene, fillings: &FillingLibrary) -> Result<f64, Error> {
    let seeds = scene.seed.iter().filter(|s| scene.count_of(s) > 0);
    let Some(heaviest) = seeds.max_by(|a, b| a.mass_kg().total_cmp(&b.mass_kg())) else {
        return Err(refused(EFFECT.name, &"the scene has no seeds"));
    };
    let weight = heaviest.mass_kg() * scene.model.gravity_m_s2;
    let reduced_radius = 0.5 * fillings.body(scene, heaviest)?.volume_radius();
    let young = reduced_modulus(scene, heaviest)?;
    // Hertz: F = 4/3 E* sqrt(R*) d^(3/2).
    let overlap = (0.75 * weight / (young * reduced_radius.sqrt())).powf(2.0 / 3.0);
    Ok(weight / contact_area(reduced_radius, overlap))
}

/// Effective Young's modulus of a seed against its like, Pa.
fn reduced_modulus(scene: &Scene, seed: &SeedSettings) -> Result<f64, Error> {
    let own = scene.material[&seed.material].constants();
    let own = own.map_err(|e| refused(EFFECT.name, &e))?;
    Ok(material::effective_moduli(&own, &own).young)
}

#[cfg(test)]
mod tests {
    use crate::effects::{apply, tests::small_drum};
    use contact_law::{HertzMindlin, LinearCohesion, NormalForceEnd, PairParameters, material};
    use scene::FillingLibrary;

    /// At amplitude 0.5 two seeds, as spheres of their volume, pressed by the weight of one attract each other by half of that
    /// weight: the overlap is that at which Hertz's force of the solver is the weight, by bisection. Every contact has the same
    /// density, and what a scene states stays. Rounding of the bisection only.
    #[test]
    fn the_attraction_is_a_share_of_the_weight_that_presses() {
        let (mut scene, fillings) = (small_drum(), FillingLibrary::default());
        scene.seed.truncate(1);
        scene
            .contact
            .get_mut("seed-seed")
            .unwrap()
            .cohesion_energy_density_j_m3 = Some(7.0);
        apply(&mut scene, "linear-cohesion", 0.5, &fillings).unwrap();
        let seed = &scene.seed[0];
        let weight = seed.mass_kg() * scene.model.gravity_m_s2;
        let radius = 0.5 * fillings.body(&scene, seed).unwrap().volume_radius();
        let m = scene.material["seed"].constants().unwrap();
        let parameters = PairParameters {
            restitution: 1.0,
            static_friction: 0.0,
            rolling_friction: 0.0,
        };
        let moduli = material::effective_moduli(&m, &m);
        let hertz = HertzMindlin::new(moduli, &parameters, NormalForceEnd::Clipped).unwrap();
        let (mut low, mut high) = (0.0, radius);
        for _ in 0..200 {
            let middle = f64::midpoint(low, high);
            if 2.0 / 3.0 * hertz.normal_stiffness(middle, radius) * middle < weight {
                low = middle;
            } else {
                high = middle;
            }
        }
        let density = |pair: &str| scene.contact[pair].cohesion_energy_density_j_m3.unwrap();
        let law = LinearCohesion::new(density("seed-tough_resin")).unwrap();
        let share = law.attraction(radius, low) / weight;
        assert!((share - 0.5).abs() < 1e-9, "{share} of the weight");
        assert!((density("seed-seed") - density("seed-clear_resin") - 7.0).abs() < 1e-9);
    }
}
