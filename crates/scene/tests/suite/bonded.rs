//! Seeds whose spheres are bodies of their own, held together by bonds.

use crate::coarse;
use scene::{BondedSettings, FillingLibrary, Scene, run, starting_frame};

/// Five coarse seeds in a drum that turns for a moment.
fn drum() -> Scene {
    coarse::five_seeds("0.04")
}

/// The same with bonds.
fn bonded() -> Scene {
    let mut scene = drum();
    scene.model.bonds = Some(BondedSettings {
        normal_stiffness_n_m3: 3e8,
        shear_stiffness_n_m3: 1.2e8,
        radius: "0.8 mm".parse().expect("a length"),
        largest_gap: "0.25 mm".parse().expect("a length"),
        damping_ratio: 0.3,
        strength: None,
    });
    scene
}

/// The pose of a seed is recovered from its spheres: at the start, before any bond is strained, it is that of the
/// rigid seed. Rounding of the mean of some twenty positions of centimetres only.
#[test]
fn bonded_seeds_start_where_rigid_ones_do() {
    let library = FillingLibrary::default();
    let (rigid, _, _) = starting_frame(&drum(), &library, 1).expect("builds");
    let (loose, _, _) = starting_frame(&bonded(), &library, 1).expect("builds");
    assert_eq!(rigid.kind, loose.kind);
    for i in 0..rigid.kind.len() {
        let apart = (rigid.position[i] - loose.position[i]).norm();
        let turned = rigid.orientation[i].angle_to(&loose.orientation[i]);
        assert!(apart < 1e-15, "seed {i} is {apart} m away");
        assert!(turned < 1e-7, "seed {i} is turned by {turned} rad");
    }
}

/// After a fall and a turn of the drum, five seeds are still there and lie in it, every bond holds; and
/// bonds of next to no strength break in the same run.
#[test]
fn bonds_hold_or_break_by_their_strength() {
    let library = FillingLibrary::default();
    let mut scene = bonded();
    let broken = |scene: &Scene| {
        let result = run(scene, &library, 1).expect("runs");
        for frame in &result.frames {
            assert_eq!(frame.kind.len(), 5, "seeds");
            assert!(
                frame.position.iter().all(|p| p.xy().norm() < 0.02),
                "a seed is out"
            );
        }
        let broken = result.observables.iter().find(|f| f.name == "broken_bonds");
        broken.expect("counted").values[0]
    };
    assert_eq!(broken(&scene), 0.0, "strong bonds");
    if let Some(bonds) = &mut scene.model.bonds {
        let weak = || "1 Pa".parse().expect("a stress");
        bonds.strength = Some([weak(), weak()]);
    }
    assert!(broken(&scene) > 0.0, "weak bonds");
}

/// Spheres that overlap would push each other apart from the start: such seeds are refused with the remedy.
#[test]
fn overlapping_spheres_cannot_be_bonded() {
    let mut scene = bonded();
    if let Some(filling) = &mut scene.seed[0].filling {
        filling.method = sphere_fill::Method::Surface;
    }
    let error = run(&scene, &FillingLibrary::default(), 1)
        .unwrap_err()
        .to_string();
    assert!(
        ["drum.toml", "ellipsoidal", "pack"]
            .iter()
            .all(|word| error.contains(word)),
        "{error}"
    );
}
