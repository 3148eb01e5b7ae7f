//! Conversions of contacts, and seeds that keep their motion.

use super::{Conversion, convert, setup};
use contact_law::{Material, material::effective_moduli};
use dev_support::fixture_files::fixture;
use nalgebra::Vector3;
use scene::{FillingLibrary, Scene, starting_frame};

fn conversion() -> Conversion {
    Conversion {
        materials: [
            Material::new(0.14, 4.01e6).unwrap(),
            Material::new(0.42, 1.04e9).unwrap(),
        ],
        coefficients: [0.13, 0.33, 0.1],
        mass_share: 1.0 / 146.0,
        lever_share: 7.0,
    }
}

/// The converted material against itself has the moduli of the pair; rounding only.
#[test]
fn moduli_of_the_pair_are_kept() {
    let from = conversion();
    let pair = effective_moduli(&from.materials[0], &from.materials[1]);
    let got = convert(&from);
    let own = Material::new(got.poisson, got.young / (2.0 * (1.0 + got.poisson))).unwrap();
    let same = effective_moduli(&own, &own);
    assert!((same.young / pair.young - 1.0).abs() < 1e-12, "{got:?}");
    assert!((same.shear / pair.shear - 1.0).abs() < 1e-12, "{got:?}");
}

/// With the mass of the body nothing changes; with that of the sphere the ratio of damping falls by
/// the root of the masses, and the restitution rises.
#[test]
fn restitution_is_that_of_the_same_dashpot_on_the_mass_of_the_body() {
    let body = Conversion {
        mass_share: 1.0,
        ..conversion()
    };
    assert!(
        (convert(&body).restitution - 0.13).abs() < 1e-14,
        "the same"
    );
    let ratio = |e: f64| -e.ln() / e.ln().hypot(std::f64::consts::PI);
    let got = ratio(convert(&conversion()).restitution) / ratio(0.13);
    assert!((got * 146_f64.sqrt() - 1.0).abs() < 1e-12, "{got}");
}

/// A seed that turns about a principal axis has the angular momentum I w along it; a seed at 45 degrees to two
/// axes has the parts of both. Values with the moments of the seed; rounding only.
#[test]
fn seeds_of_a_frame_keep_their_motion() {
    let file = fixture("cotton/drum.toml");
    let scene = Scene::read(&file, &[]).unwrap();
    let (mut frame, bodies, step) = starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
    let turn = frame.orientation[1];
    frame.velocity[1] = Vector3::new(0.1, 0.2, -0.3);
    frame.spin[0] = frame.orientation[0] * Vector3::new(0.0, 0.0, 5.0);
    frame.spin[1] = turn * Vector3::new(2.0, 2.0, 0.0);
    let files = setup(&scene, &bodies, &frame, step).unwrap();
    let row = |i: usize| -> Vec<f64> {
        let line = files[2].text.lines().nth(i + 1).unwrap();
        line.split_whitespace()
            .map(|word| word.parse().unwrap())
            .collect()
    };
    let moments = [0, 1].map(|i| bodies[frame.kind[i]].clump.inertia());
    let momentum = |i: usize| Vector3::from_column_slice(&row(i)[14..17]);
    let near = |got: Vector3<f64>, expected: Vector3<f64>| {
        let error = (got - expected).norm() / expected.norm();
        assert!(error < 1e-12, "{got} for {expected}");
    };
    near(momentum(0), moments[0].z * frame.spin[0]);
    let both = Vector3::new(2.0 * moments[1].x, 2.0 * moments[1].y, 0.0);
    near(momentum(1), turn * both);
    assert_eq!(row(1)[11..14], [0.1, 0.2, -0.3]);
}

#[test]
fn rolling_friction_takes_the_lever_arm_along() {
    let got = convert(&conversion()).rolling_friction;
    assert!((got - 0.7).abs() < 1e-15, "{got}");
}
