//! Every sphere of every seed at one moment, as a fluid around them needs it.

use geometry::clump::Sphere;
use nalgebra::Vector3;
use scene::{Frame, SeedBody};
use std::sync::Arc;

/// A sphere of a seed, hidden ones included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fraction {
    /// Number of the seed.
    pub body: usize,
    /// Kind of the seed.
    pub kind: usize,
    /// Where the sphere is and how large, m.
    pub sphere: Sphere,
    /// Its share of the volume of the seed, m³.
    pub volume: f64,
    /// Velocity of its centre, m/s.
    pub velocity: Vector3<f64>,
}

/// All spheres of a frame, seed by seed.
///
/// # Formula
///
/// `V_k = V R_k^3 / sum R^3`, with V the volume of the seed: the fractions of a seed add up to the volume that
/// the seed takes from the fluid, however much its spheres overlap or leave free.
pub fn fractions(frame: &Frame, bodies: &[Arc<SeedBody>]) -> Vec<Fraction> {
    let volumes: Vec<f64> = bodies.iter().map(|b| b.volume).collect();
    let mut all = Vec::new();
    for (body, &kind) in frame.kind.iter().enumerate() {
        let clump = &bodies[kind].clump;
        for (k, sphere) in clump.spheres().iter().enumerate() {
            let arm = frame.orientation[body] * sphere.centre;
            all.push(Fraction {
                body,
                kind,
                sphere: Sphere {
                    centre: frame.position[body] + arm,
                    radius: sphere.radius,
                },
                volume: volumes[kind] * clump.fraction_mass(k) / clump.mass(),
                velocity: frame.velocity[body] + frame.spin[body].cross(&arm),
            });
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::fractions;
    use dev_support::fixture_files::fixture;
    use scene::{FillingLibrary, Override, Scene, starting_frame};

    /// The fractions of a seed have its volume together, hidden spheres are there, and a seed that turns about its centre
    /// keeps its momentum: velocities weighed with the volumes are those of the centre, as packed spheres of one size have
    /// their centre near that of the mesh. Within 5 % of the fastest sphere.
    #[test]
    fn fractions_carry_the_volume_of_the_seed() {
        let file = fixture("cotton/drum.toml");
        let few = ["seed.0.count", "seed.1.count"].map(|name| Override {
            name: name.into(),
            value: "3".into(),
        });
        let scene = Scene::read(&file, &few).unwrap();
        let (mut frame, bodies, _) = starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
        frame.spin[4] = nalgebra::Vector3::new(3.0, -1.0, 2.0);
        let all = fractions(&frame, &bodies);
        let whole: usize = frame
            .kind
            .iter()
            .map(|k| bodies[*k].clump.spheres().len())
            .sum();
        assert_eq!(all.len(), whole, "hidden spheres too");
        for (body, &kind) in frame.kind.iter().enumerate() {
            let own = all.iter().filter(|f| f.body == body);
            let volume: f64 = own.clone().map(|f| f.volume).sum();
            let expected = bodies[kind].volume;
            assert!((volume / expected - 1.0).abs() < 1e-12, "{volume} m3");
            let momentum: nalgebra::Vector3<f64> = own.clone().map(|f| f.velocity * f.volume).sum();
            let fastest = own.map(|f| f.velocity.norm()).fold(0.0, f64::max);
            let drift = (momentum / volume - frame.velocity[body]).norm();
            assert!(drift <= 0.05 * fastest, "{drift} of {fastest} m/s");
        }
    }
}
