//! Every file, read back by its own rules, holds the body that was written.

use geometry::clump::files::{Body, Format, write};
use geometry::clump::{MassProperties, Sphere, properties_of_spheres};
use nalgebra::Vector3;

const SPHERES: [Sphere; 3] = [
    Sphere {
        centre: Vector3::new(1e-3, 2e-3, -3e-3),
        radius: 0.45e-3,
    },
    Sphere {
        centre: Vector3::new(1e-7, 0.0, 4e-3),
        radius: 0.6e-3,
    },
    Sphere {
        centre: Vector3::new(-2e-3, 1e-3, 0.0),
        radius: 0.5e-3,
    },
];

const MASS: f64 = 94.5e-6;

fn properties() -> MassProperties {
    properties_of_spheres(&SPHERES, 1.0)
}

fn body(mass: Option<f64>) -> Body<'static> {
    let whole = properties();
    Body {
        spheres: &SPHERES,
        name: "my seed.stl",
        unit: ("mm", 1e-3),
        volume: whole.mass,
        centroid: whole.centre,
        inertia: whole.inertia,
        mass,
    }
}

/// Numbers of a line, with any text between them.
fn numbers(line: &str) -> Vec<f64> {
    let words = line.split([' ', ',']).filter(|word| !word.is_empty());
    words.filter_map(|word| word.parse().ok()).collect()
}

#[track_caller]
fn assert_spheres(found: &[[f64; 4]], metres: f64) {
    assert_eq!(found.len(), SPHERES.len());
    for ([x, y, z, r], sphere) in found.iter().zip(SPHERES) {
        let c = sphere.centre;
        for (found, exact) in [(x, c.x), (y, c.y), (z, c.z), (r, sphere.radius)] {
            assert!((found * metres - exact).abs() < 1e-18, "{found}");
        }
    }
}

#[test]
fn plain_tables_hold_centre_and_radius_of_each_sphere() {
    for (format, metres, columns) in [
        (Format::Csv, 1e-3, 4),
        (Format::Liggghts, 1.0, 4),
        (Format::Yade, 1.0, 5),
    ] {
        let text = write(format, &body(Some(MASS)));
        let lines = text.lines().filter(|line| !line.starts_with(['#', 'x']));
        let rows: Vec<Vec<f64>> = lines.map(numbers).collect();
        assert!(rows.iter().all(|row| row.len() == columns), "{text}");
        let spheres: Vec<[f64; 4]> = rows.iter().map(|r| [r[0], r[1], r[2], r[3]]).collect();
        assert_spheres(&spheres, metres);
    }
}

/// The command in the comment carries mass and inertia in the order xx, xy, xz, yy, yz, zz.
#[test]
fn the_liggghts_command_names_mass_and_inertia() {
    let text = write(Format::Liggghts, &body(Some(MASS)));
    let command = text
        .lines()
        .find(|line| line.contains("nspheres 3"))
        .unwrap();
    let (_, end) = command.split_once("inertia_tensor ").unwrap();
    let found = numbers(end);
    let exact = properties().inertia * (MASS / properties().mass);
    for (value, at) in found
        .iter()
        .zip([(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)])
    {
        assert!((value / exact[at] - 1.0).abs() < 1e-12);
    }
    assert!(!write(Format::Liggghts, &body(None)).contains("inertia_tensor"));
}

/// Section of a molecule file without the number that begins each line.
fn section(text: &str, name: &str) -> Vec<Vec<f64>> {
    let lines = text.lines().skip_while(|line| *line != name).skip(2);
    let lines = lines.take_while(|line| !line.is_empty());
    lines.map(|line| numbers(line)[1..].to_vec()).collect()
}

/// The molecule is the body in its principal frame: the same distances to the centroid, radii,
/// mass, and principal moments.
#[test]
fn the_lammps_molecule_has_the_mass_and_inertia_of_the_seed() {
    let text = write(Format::Lammps, &body(Some(MASS)));
    let centre = properties().centre;
    for ((c, d), sphere) in section(&text, "Coords")
        .iter()
        .zip(section(&text, "Diameters"))
        .zip(SPHERES)
    {
        let distance = Vector3::new(c[0], c[1], c[2]).norm();
        assert!((distance - (sphere.centre - centre).norm()).abs() < 1e-15);
        assert!((d[0] / 2.0 - sphere.radius).abs() < 1e-18);
    }
    let sum: f64 = section(&text, "Masses").iter().map(|mass| mass[0]).sum();
    assert!((sum / MASS - 1.0).abs() < 1e-12);
    let of_line = |end: &str| numbers(text.lines().find(|line| line.ends_with(end)).unwrap());
    assert_eq!(of_line(" atoms"), [3.0]);
    assert_eq!(of_line(" mass"), [MASS]);
    let mut exact = (properties().inertia * (MASS / properties().mass)).symmetric_eigenvalues();
    exact.as_mut_slice().sort_by(f64::total_cmp);
    let found = of_line(" inertia");
    for k in 0..3 {
        assert!((found[k] / exact[k] - 1.0).abs() < 1e-12);
    }
    assert_eq!(found[3..], [0.0; 3]);
    assert!(!write(Format::Lammps, &body(None)).contains("inertia"));
    let first = write(Format::Lammps, &body(Some(1e-4)));
    let first = first.lines().next().unwrap();
    assert!(
        first.starts_with("# ") && first.contains("fix deposit"),
        "{first}"
    );
}

/// In the EDEM table the products of inertia vanish and the centre of mass is the origin: what
/// EDEM asks for. The mutual distances are those of the body.
#[test]
fn the_edem_table_is_in_the_principal_frame() {
    let text = write(Format::Edem, &body(None));
    let spheres: Vec<Sphere> = text
        .lines()
        .skip(1)
        .map(|line| numbers(line.split_once(',').unwrap().1))
        .map(|row| Sphere {
            centre: Vector3::new(row[2], row[3], row[4]),
            radius: row[0],
        })
        .collect();
    let found = properties_of_spheres(&spheres, 1.0);
    assert!(found.centre.norm() < 1e-15);
    let scale = found.inertia.norm();
    for at in [(0, 1), (0, 2), (1, 2)] {
        assert!(found.inertia[at].abs() < 1e-12 * scale, "{}", found.inertia);
    }
    let apart = |s: &[Sphere]| (s[0].centre - s[1].centre).norm();
    assert!((apart(&spheres) / apart(&SPHERES) - 1.0).abs() < 1e-12);
}

#[test]
fn the_pfc_template_has_volume_and_inertia_at_unit_density() {
    let text = write(Format::Pfc, &body(Some(MASS)));
    assert!(text.contains("name 'my_seed_stl' ..."), "{text}");
    let number_after = |word: &str| {
        let line = text.lines().find(|line| line.trim().starts_with(word));
        numbers(line.unwrap())
    };
    let exact = properties();
    assert_eq!(number_after("pebbles"), [3.0]);
    assert!((number_after("volume")[0] / exact.mass - 1.0).abs() < 1e-12);
    let inertia = number_after("inertia");
    assert!((inertia[0] / exact.inertia[(0, 0)] - 1.0).abs() < 1e-12);
    assert!((inertia[5] / exact.inertia[(1, 2)] - 1.0).abs() < 1e-12);
    // All lines of the command but the last go on.
    let lines: Vec<&str> = text.lines().skip(1).collect();
    let (last, others) = lines.split_last().unwrap();
    assert!(others.iter().all(|line| line.ends_with("...")) && !last.ends_with("..."));
}

#[test]
fn vtk_declares_as_many_points_as_it_lists() {
    let text = write(Format::Vtk, &body(None));
    let after = |word: &str| {
        let lines = text.lines().skip_while(|line| !line.starts_with(word));
        lines.skip(1).take(3).map(numbers).collect::<Vec<_>>()
    };
    assert!(text.contains("POINTS 3 double") && text.contains("POINT_DATA 3"));
    assert!(after("POINTS").iter().all(|point| point.len() == 3));
    let radii: Vec<f64> = after("LOOKUP_TABLE").concat();
    for (found, exact) in radii.iter().zip([0.45, 0.6, 0.5]) {
        assert!((found - exact).abs() < 1e-15);
    }
    assert_eq!(radii.len(), 3);
}

#[test]
fn extensions_name_formats_only_where_they_are_plain() {
    assert_eq!(Format::of_extension("csv"), Some(Format::Csv));
    assert_eq!(Format::of_extension("txt"), None);
    for format in Format::ALL {
        assert_eq!(format.name(), format!("{format:?}").to_lowercase());
    }
}
