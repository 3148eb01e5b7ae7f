//! Methods of overlapping spheres: what each promises, and how they compare.

use geometry::clump::Sphere;
use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;
use sphere_fill::{
    Body, DistanceTransform, Error, Favier, Ferellec, FillSettings, Filling, FitReport,
    InertiaSource, Lattice, Method, Pack, Place, Smooth, Surface, Target, fill, measure,
};
use trimesh::{LengthUnit, SignedDistance, TriMesh, shapes};

const CLUMPS: [Method; 5] = [
    Method::Smooth,
    Method::Surface,
    Method::Favier,
    Method::Ferellec,
    Method::DistanceTransform,
];

fn seed() -> TriMesh {
    shapes::ellipsoid([3.2e-3, 1.7e-3, 1.4e-3], 16).expect("positive sizes")
}

fn with(method: Method, count: usize) -> FillSettings {
    FillSettings {
        method,
        count: Some(count),
        effort: 0.5,
        ..FillSettings::new(0.15e-3)
    }
}

fn filled(mesh: &TriMesh, method: Method, count: usize) -> Filling {
    fill(mesh, &with(method, count)).expect("a filling")
}

fn worst_inertia(filling: &Filling) -> f64 {
    let errors = filling.report.inertia_error_percent;
    errors.iter().fold(0.0, |m: f64, e| m.max(e.abs()))
}

/// The count is exact, no sphere is smaller than asked, the same settings give the same spheres.
#[test]
fn every_method_keeps_count_and_least_radius_and_is_repeatable() {
    let mesh = seed();
    for method in CLUMPS {
        let filling = filled(&mesh, method, 20);
        assert_eq!(filling.spheres.len(), 20, "{method:?}");
        let least = filling
            .spheres
            .iter()
            .fold(1.0, |m: f64, s| m.min(s.radius));
        assert!(least >= 0.998 * 0.15e-3, "{method:?}: {least}");
        assert_eq!(
            filling,
            filled(&mesh, method, 20),
            "{method:?} is not repeatable"
        );
    }
}

/// The methods of the literature place inscribed spheres: none stands out by more than the
/// slack of the shrinking ball, 0.1 % of the largest radius.
#[test]
fn inscribed_spheres_stay_inside() {
    let mesh = seed();
    for method in [
        Method::Smooth,
        Method::Favier,
        Method::Ferellec,
        Method::DistanceTransform,
    ] {
        let out = filled(&mesh, method, 20).report.max_protrusion;
        assert!(out <= 1.5e-6, "{method:?}: {out}");
    }
}

/// At equal count the fitted spheres have less surface error than the inscribed ones, whose
/// error is one-sided (least squares about a mean of 0 against a positive gap: at least 1.5
/// times), the volume of the body to the quadrature error, and less error of inertia.
#[test]
fn fitted_spheres_beat_inscribed_ones() {
    for mesh in [seed(), shapes::torus(3e-3, 1e-3, 36, 18).expect("a torus")] {
        let fitted = filled(&mesh, Method::Surface, 40);
        assert!((fitted.report.union_fraction - 1.0).abs() < 1e-4);
        for method in [Method::Smooth, Method::Ferellec, Method::DistanceTransform] {
            let other = filled(&mesh, method, 40);
            let ratio = other.report.surface_rms / fitted.report.surface_rms;
            assert!(ratio > 1.5, "{method:?}: {ratio}");
            assert!(worst_inertia(&other) > worst_inertia(&fitted), "{method:?}");
        }
    }
}

/// In a ring the fitted spheres lie in the tube: none grows into the hole, where it would follow
/// the surface from outside.
#[test]
fn fitted_spheres_stay_in_a_ring() {
    let mesh = shapes::torus(3e-3, 1e-3, 36, 18).unwrap();
    let distance = SignedDistance::new(&mesh).unwrap();
    for sphere in &filled(&mesh, Method::Surface, 30).spheres {
        let depth = -distance.distance(&sphere.centre);
        assert!(depth > 0.4 * sphere.radius, "{sphere:?} is {depth} m deep");
    }
}

/// A ball is one sphere: of its own radius, to the volume that the facets cut off.
#[test]
fn one_fitted_sphere_is_the_ball() {
    let mesh = shapes::ellipsoid([1e-3, 1e-3, 1e-3], 24).unwrap();
    let filling = filled(&mesh, Method::Surface, 1);
    let Sphere { centre, radius } = filling.spheres[0];
    assert!(centre.norm() < 2e-6, "{centre}");
    assert!((radius - 1e-3).abs() < 2e-6, "{radius}");
}

/// The ends of a slender ellipsoid are curved by b²/a: the outermost spheres on its axis have
/// nearly that radius when they may be so small, and all centres lie on the axis.
#[test]
fn spheres_on_the_axis_lie_on_the_axis() {
    let mesh = shapes::ellipsoid([4e-3, 1e-3, 1e-3], 24).unwrap();
    let filling = filled(&mesh, Method::Favier, 15);
    for sphere in &filling.spheres {
        assert!(sphere.centre.yz().norm() < 1e-5, "{}", sphere.centre);
    }
    let largest = filling
        .spheres
        .iter()
        .fold(0.0, |m: f64, s| m.max(s.radius));
    assert!((largest / 1e-3 - 1.0).abs() < 0.01, "{largest}");
}

/// More spheres never give a larger error than twice fewer, for each method that follows the
/// surface.
#[test]
fn errors_fall_with_the_count() {
    let mesh = seed();
    for method in [
        Method::Smooth,
        Method::Surface,
        Method::Ferellec,
        Method::DistanceTransform,
    ] {
        let rms = [10, 20, 40].map(|n| filled(&mesh, method, n).report.surface_rms);
        assert!(rms[0] > rms[1] && rms[1] > rms[2], "{method:?}: {rms:?}");
    }
}

#[test]
fn a_target_takes_few_spheres_and_an_impossible_one_is_refused() {
    let mesh = seed();
    let target = Target {
        volume: Some(0.01),
        inertia: Some(0.02),
        surface: Some(0.03e-3),
    };
    let settings = |method, target| FillSettings {
        method,
        target: Some(target),
        effort: 0.3,
        ..FillSettings::new(0.15e-3)
    };
    let filling = fill(&mesh, &settings(Method::Surface, target)).unwrap();
    assert!(target.is_met(&filling.report));
    let n = filling.spheres.len();
    assert!(n < 25, "{n} spheres");
    // The search took the fewest: one less misses the target.
    let fewer = FillSettings {
        count: Some(n - 1),
        ..settings(Method::Surface, target)
    };
    assert!(matches!(
        fill(&mesh, &fewer),
        Err(Error::TargetNotReached { .. })
    ));
    // Inscribed spheres on the axis of a body that is not round cannot have its volume.
    let axial = fill(&mesh, &settings(Method::Favier, target));
    assert!(
        matches!(axial, Err(Error::TargetNotReached { .. })),
        "{axial:?}"
    );
    let zero = Target {
        volume: Some(0.0),
        ..target
    };
    assert!(fill(&mesh, &settings(Method::Surface, zero)).is_err());
}

/// The radius is only a bound here: a tiny one is not a reason to refuse, nor to place more spheres.
#[test]
fn a_tiny_least_radius_is_allowed() {
    for method in CLUMPS {
        let settings = FillSettings {
            radius: 1e-6,
            ..with(method, 12)
        };
        let filling = fill(&seed(), &settings).expect("a filling");
        assert_eq!(filling.spheres.len(), 12, "{method:?}");
    }
}

#[test]
fn a_limit_of_spheres_is_kept() {
    let settings = FillSettings {
        max_spheres: Some(12),
        ..with(Method::Pack, 1)
    };
    for method in [
        Method::Pack,
        Method::Lattice,
        Method::Surface,
        Method::Ferellec,
    ] {
        let settings = FillSettings {
            method,
            count: None,
            radius: 0.4e-3,
            ..settings
        };
        assert_eq!(
            fill(&seed(), &settings).unwrap().spheres.len(),
            12,
            "{method:?}"
        );
    }
}

#[test]
fn spheres_from_elsewhere_are_measured_or_refused() {
    let mesh = seed();
    let filling = filled(&mesh, Method::Surface, 10);
    let again = measure(&mesh, filling.spheres.clone()).unwrap();
    assert_eq!(again.report, filling.report);
    let bad = Sphere {
        radius: f64::NAN,
        ..filling.spheres[0]
    };
    assert!(measure(&mesh, vec![bad]).is_err() && measure(&mesh, vec![]).is_err());
}

fn moved(mesh: &TriMesh, turn: &Rotation3<f64>, scale: f64, shift: Vector3<f64>) -> TriMesh {
    let soup: Vec<_> = (0..mesh.triangles().len())
        .map(|t| mesh.corners(t).map(|c| turn * c * scale + shift))
        .collect();
    TriMesh::from_triangles(&soup, LengthUnit::Metre, "moved")
        .expect("a mesh")
        .mesh
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    /// Moved, turned and scaled, the same body gets a filling of the same quality: the figures are
    /// lengths (scale with the body) or ratios (stay). In twenty motions the surface error of the
    /// fitted spheres changed by less than 5e-7 of itself (a tie decided otherwise could change
    /// more), the number of packed spheres, whose search draws places on a grid along the axes,
    /// by at most 1.
    #[test]
    fn motion_and_scale_change_a_filling_within_bounds(
        angles in prop::array::uniform3(-3.0..3.0),
        scale in 0.1..10.0,
        shift in prop::array::uniform3(-0.05..0.05),
    ) {
        let mesh = seed();
        let turn = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
        let other = moved(&mesh, &turn, scale, Vector3::from(shift));
        let there = |settings: FillSettings| FillSettings {
            radius: settings.radius * scale,
            ..settings
        };
        let fitted = with(Method::Surface, 20);
        let (a, b) = (fill(&mesh, &fitted).unwrap(), fill(&other, &there(fitted)).unwrap());
        let ratio = b.report.surface_rms / (a.report.surface_rms * scale);
        prop_assert!((ratio - 1.0).abs() < 0.01, "surface error {ratio}");
        prop_assert!((b.report.union_fraction - 1.0).abs() < 1e-4);
        let packed = FillSettings { method: Method::Pack, count: None, effort: 0.05, ..FillSettings::new(0.45e-3) };
        let (a, b) = (fill(&mesh, &packed).unwrap(), fill(&other, &there(packed)).unwrap());
        prop_assert!(a.spheres.len().abs_diff(b.spheres.len()) <= 2);
        prop_assert!(b.report.max_overlap <= 1e-3 * 0.45e-3 * scale);
        prop_assert!(b.report.max_protrusion <= 1e-2 * 0.45e-3 * scale);
    }
}

/// All methods from 6 um to 6 m: lengths times a power of two change no bit of a coordinate but its exponent, so the spheres are
/// the same to the last bit, times that power, if no length, tolerance or limit of the work is absolute. So are the figures.
#[test]
fn every_method_fills_a_body_of_any_size_alike() {
    let still = Rotation3::identity();
    let bumpy = |c: Vector3<f64>| c * (1.0 + 0.1 * (900.0 * c.x).sin() * (1300.0 * c.y).cos());
    let ball = shapes::ellipsoid([3.2e-3, 1.7e-3, 1.4e-3], 6).unwrap();
    let soup: Vec<_> = (0..ball.triangles().len())
        .map(|t| ball.corners(t).map(bumpy))
        .collect();
    let mesh = TriMesh::from_triangles(&soup, LengthUnit::Metre, "bumpy")
        .unwrap()
        .mesh;
    let settings = |factor: f64| FillSettings {
        effort: 0.02,
        count: Some(9),
        ..FillSettings::new(0.45e-3 * factor)
    };
    let scaled = |spheres: &[Sphere], factor: f64| -> Vec<Sphere> {
        let one = |s: &Sphere| Sphere {
            centre: s.centre * factor,
            radius: s.radius * factor,
        };
        spheres.iter().map(one).collect()
    };
    let methods: [(&str, &dyn Place); 7] = [
        ("pack", &Pack),
        ("lattice", &Lattice),
        ("smooth", &Smooth),
        ("surface", &Surface),
        ("favier", &Favier),
        ("ferellec", &Ferellec),
        ("distance transform", &DistanceTransform),
    ];
    let factors = [1.0, 2.0_f64.powi(-10), 2.0_f64.powi(10)];
    let meshes = factors.map(|factor| moved(&mesh, &still, factor, Vector3::zeros()));
    let bodies = meshes.each_ref().map(|mesh| Body::new(mesh).unwrap());
    for (name, method) in methods {
        let usual = method.place(&bodies[0], &settings(1.0)).unwrap();
        for (body, factor) in bodies.iter().zip(factors) {
            let found = method.place(body, &settings(factor)).unwrap();
            assert_eq!(found, scaled(&usual, factor), "{name} times {factor}");
        }
    }
    let spheres = Favier.place(&bodies[0], &settings(1.0)).unwrap();
    let [usual, small, large] = [0, 1, 2].map(|k| {
        let (spheres, factor) = (scaled(&spheres, factors[k]), factors[k]);
        let report = measure(&meshes[k], spheres).unwrap().report;
        FitReport {
            max_protrusion: report.max_protrusion / factor,
            max_overlap: report.max_overlap / factor,
            surface_rms: report.surface_rms / factor,
            surface_hausdorff: report.surface_hausdorff / factor,
            roughness_rms: report.roughness_rms / factor,
            mean_gap: report.mean_gap / factor,
            centroid_offset: report.centroid_offset / factor,
            ..report
        }
    });
    assert_eq!([small, large], [usual; 2]);
}

/// The advice of a refusal holds when it is followed: a larger limit allows more spheres than the usual 400; a target that no number
/// of inscribed spheres reaches is a target that is not reached, not a count that nobody asked for; more effort finds no more of
/// spheres that are not searched for.
#[test]
fn the_advice_of_a_refusal_can_be_followed() {
    let mesh = seed();
    let smooth = FillSettings {
        method: Method::Smooth,
        max_spheres: Some(410),
        roughness: Some(1e-9),
        ..FillSettings::new(0.05e-3)
    };
    let refused = fill(&mesh, &smooth).unwrap_err().to_string();
    assert!(refused.contains("; 410 spheres reach"), "{refused}");
    let few = FillSettings {
        method: Method::DistanceTransform,
        target: Some(Target {
            surface: Some(1e-9),
            ..Target::default()
        }),
        ..FillSettings::new(0.8e-3)
    };
    let refused = fill(&mesh, &few).unwrap_err();
    assert!(
        matches!(refused, Error::TargetNotReached { .. }),
        "{refused}"
    );
    for (method, by_effort) in [(Method::DistanceTransform, false), (Method::Lattice, true)] {
        let many = FillSettings {
            method,
            count: Some(300),
            effort: 0.01,
            ..FillSettings::new(0.8e-3)
        };
        let refused = fill(&mesh, &many).unwrap_err().to_string();
        assert!(refused.contains("fewer or smaller"), "{refused}");
        assert_eq!(refused.contains("effort"), by_effort, "{refused}");
    }
}

/// Roughness as a factor: the series has the volume of the seed at each level (0.1 %, ten times
/// what the radii are set to), mass and inertia to rounding, and the roughness asked for; as spheres
/// are whole, one fewer is too rough, and the reached value lies a little below (a quarter at
/// 10 spheres, where a sphere more or less counts most).
#[test]
fn a_series_of_roughness_keeps_volume_mass_and_inertia() {
    let mesh = seed();
    let mass = 94.5e-6;
    let series: Vec<Filling> = [0.06e-3, 0.03e-3, 0.015e-3]
        .map(|roughness| {
            let settings = FillSettings {
                method: Method::Surface,
                roughness: Some(roughness),
                effort: 0.2,
                ..FillSettings::new(0.2e-3)
            };
            let filling = fill(&mesh, &settings).unwrap();
            let reached = filling.report.roughness_rms;
            assert!(
                reached <= roughness && reached > 0.75 * roughness,
                "{reached} for {roughness}"
            );
            filling
        })
        .into();
    let first = series[0].clump(mass, InertiaSource::Mesh).unwrap();
    for pair in series.windows(2) {
        assert!(pair[1].spheres.len() > pair[0].spheres.len());
    }
    for filling in &series {
        assert!((filling.report.union_fraction - 1.0).abs() < 1e-3);
        let body = filling.clump(mass, InertiaSource::Mesh).unwrap();
        assert_eq!(body.mass(), mass);
        assert!((body.inertia() - first.inertia()).norm() < 1e-12 * first.inertia().norm());
    }
    let impossible = FillSettings {
        method: Method::Surface,
        roughness: Some(1e-9),
        max_spheres: Some(10),
        effort: 0.05,
        ..FillSettings::new(0.2e-3)
    };
    assert!(matches!(
        fill(&mesh, &impossible),
        Err(Error::RoughnessNotReached { .. })
    ));
}
