//! The files of bodies, read by the programs that they are for: slow, and only where these are installed (`just
//! body-files`).
//!
//! One seed of twelve overlapping spheres, so that no program can work out mass and inertia from separate spheres unseen.

use super::{fixture, json_of, path_text, seedfill, text};
use nalgebra::{Matrix3, Vector3};
use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// Mass of the seed, kg.
const MASS: f64 = 94.5e-6;

/// Writes the seed in a format into a folder; the JSON beside it.
fn seed(folder: &Path, format: &str) -> Value {
    let (mesh, file) = (
        fixture("cotton_flat.stl"),
        folder.join(format!("seed.{format}")),
    );
    let words = [
        path_text(&mesh),
        "--method",
        "surface",
        "--radius",
        "0.2",
        "--count",
        "12",
        "--mass",
        "94.5e-6",
        "--json",
        "--quiet",
        "--format",
        format,
        "--out",
        path_text(&file),
    ];
    let output = seedfill(&words);
    assert!(output.status.success(), "{}", text(&output.stderr));
    json_of(&output)
}

/// Centres and radii of the seed, m.
fn spheres(folder: &Path) -> Vec<[f64; 4]> {
    seed(folder, "csv");
    let table = std::fs::read_to_string(folder.join("seed.csv")).expect("the table");
    let rows = table.lines().skip(1);
    rows.map(|row| numbers(&row.replace(',', " ")).map(|mm| 1e-3 * mm))
        .collect()
}

fn numbers<const N: usize>(line: &str) -> [f64; N] {
    let all: Vec<f64> = line
        .split_whitespace()
        .map(|n| n.parse().expect("a number"))
        .collect();
    all.try_into().expect("so many numbers")
}

/// Runs a program in a folder; what it printed.
fn run(folder: &Path, program: &str, words: &[&str]) -> String {
    let output = Command::new(program)
        .args(words)
        .current_dir(folder)
        .env("OMP_NUM_THREADS", "1")
        .output()
        .unwrap_or_else(|e| {
            unreachable!("{program}: {e}; `trials/programs.sh body-files` installs it")
        });
    let told = text(&output.stdout);
    assert!(output.status.success(), "{told}{}", text(&output.stderr));
    told
}

/// What follows a word in a text, up to the end of the line.
fn after<'a>(told: &'a str, word: &str) -> &'a str {
    let line = told.lines().find_map(|line| line.strip_prefix(word));
    line.unwrap_or_else(|| unreachable!("no {word} in {told}"))
}

/// Centres and radii in the last moment of a dump of LIGGGHTS or LAMMPS, m.
fn dumped(file: &Path) -> Vec<[f64; 4]> {
    let dump = std::fs::read_to_string(file).expect("the dump");
    let (_, last) = dump
        .rsplit_once("ITEM: ATOMS id x y z radius")
        .expect("a moment");
    let rows = last.lines().skip(1).map(|line| {
        let [_, x, y, z, radius] = numbers(line);
        [x, y, z, radius]
    });
    rows.collect()
}

/// Holds spheres to others by their radii and mutual distances, which no motion of the body changes, to a part of the size of
/// the body (9 mm).
fn hold(found: &[[f64; 4]], expected: &[[f64; 4]], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    let apart = |all: &[[f64; 4]], i: usize, j: usize| {
        let [a, b] = [i, j].map(|k| Vector3::new(all[k][0], all[k][1], all[k][2]));
        (a - b).norm()
    };
    for i in 0..found.len() {
        assert!((found[i][3] - expected[i][3]).abs() < 9e-3 * tolerance);
        for j in 0..i {
            let off = apart(found, i, j) - apart(expected, i, j);
            assert!(off.abs() < 9e-3 * tolerance, "{i} {j}: {off} m");
        }
    }
}

/// Principal moments and axes of the mesh, kg m2; axes in rows.
fn moments(json: &Value) -> ([f64; 3], Matrix3<f64>) {
    let mesh = &json["moments"]["mesh"];
    let list = |value: &Value| [0, 1, 2].map(|i| value[i].as_f64().expect("a number"));
    let axes = [0, 1, 2].map(|i| Vector3::from(list(&mesh["axes"][i])).transpose());
    (list(&mesh["principal_kg_m2"]), Matrix3::from_rows(&axes))
}

/// LIGGGHTS reads its template by the command in the file: twelve spheres, and the kinetic energy of the seed that moves with 2
/// m/s (m v^2 / 2) and turns with 10 rad/s about each axis and each pair of them (w I w / 2) shows mass and the whole inertia
/// tensor, to 1e-9. Its dump has six digits: 1e-5 m of positions of 0.02 m.
#[test]
#[ignore = "needs LIGGGHTS: trials/programs.sh body-files"]
fn liggghts_reads_its_template() {
    let folder = tempfile::tempdir().unwrap();
    let json = seed(folder.path(), "liggghts");
    let (principal, axes) = moments(&json);
    let inertia = axes.transpose() * Matrix3::from_diagonal(&principal.into()) * axes;
    let file = std::fs::read_to_string(folder.path().join("seed.liggghts")).unwrap();
    let command = file
        .lines()
        .find_map(|line| line.strip_prefix("# fix "))
        .unwrap();
    let command = command
        .replace("DENSITY", "1000")
        .replace("FILE", "seed.liggghts");
    let name = command.split(' ').next().unwrap().to_owned();
    for spin in [
        [1, 0, 0],
        [0, 1, 0],
        [0, 0, 1],
        [1, 1, 0],
        [1, 0, 1],
        [0, 1, 1],
    ] {
        let [x, y, z] = spin.map(|part| 10 * part);
        let deck = format!(
            "units si\natom_style granular\natom_modify map array\nboundary f f f\nnewton off\n\
             communicate single vel yes\nregion box block -0.05 0.05 -0.05 0.05 -0.05 0.05 units box\ncreate_box 1 box\n\
             neighbor 0.001 bin\nneigh_modify delay 0\nfix m1 all property/global youngsModulus peratomtype 1e7\n\
             fix m2 all property/global poissonsRatio peratomtype 0.3\n\
             fix m3 all property/global coefficientRestitution peratomtypepair 1 0.5\n\
             fix m4 all property/global coefficientFriction peratomtypepair 1 0.5\n\
             pair_style gran model hertz tangential history\npair_coeff * *\ntimestep 1e-9\nfix {command}\n\
             fix pdd all particledistribution/discrete 15485867 1 {name} 1.0\n\
             region one block -0.02 0.02 -0.02 0.02 -0.02 0.02 units box\n\
             fix ins all insert/pack seed 32452843 distributiontemplate pdd maxattempt 200 insert_every once overlapcheck \
             yes orientation template vel constant 0 0 2 omega constant {x} {y} {z} region one particles_in_region 1\n\
             fix ms all multisphere\ncompute ke all ke/multisphere\ncompute er all erotate/multisphere\n\
             thermo_style custom step atoms c_ke c_er\ndump d all custom 1 dump.txt id x y z radius\n\
             dump_modify d sort id\nrun 1\nprint \"energies $(c_ke) $(c_er)\"\n"
        );
        std::fs::write(folder.path().join("in.body"), deck).unwrap();
        let told = run(folder.path(), "liggghts", &["-in", "in.body"]);
        let [moving, turning] = numbers(after(&told, "energies "));
        let omega = Vector3::new(f64::from(x), f64::from(y), f64::from(z));
        let expected = [0.5 * MASS * 4.0, 0.5 * omega.dot(&(inertia * omega))];
        assert!((moving / expected[0] - 1.0).abs() < 1e-9, "{moving}");
        assert!(
            (turning / expected[1] - 1.0).abs() < 1e-9,
            "{spin:?}: {turning}"
        );
    }
    let found = dumped(&folder.path().join("dump.txt"));
    hold(&found, &spheres(folder.path()), 2e-5);
}

/// LAMMPS takes the molecule into a rigid body: its mass and its principal moments are those of the seed, and the spheres lie as they
/// should, to 1e-9.
#[test]
#[ignore = "needs LAMMPS: trials/programs.sh body-files"]
fn lammps_reads_its_molecule() {
    let folder = tempfile::tempdir().unwrap();
    let json = seed(folder.path(), "lammps");
    let deck = "units si\natom_style sphere\natom_modify map array\nboundary f f f\ncomm_modify vel yes\n\
                region box block -0.05 0.05 -0.05 0.05 -0.05 0.05\ncreate_box 1 box\nfix mol all property/atom mol ghost yes\n\
                molecule seed seed.lammps\npair_style zero 0.01\npair_coeff * *\ntimestep 1e-9\n\
                region one block -0.001 0.001 -0.001 0.001 -0.001 0.001\nfix rig all rigid/small molecule mol seed\n\
                fix dep all deposit 1 0 1 12345 mol seed region one vz 2 2 rigid rig\n\
                compute b all rigid/local rig mol mass inertiax inertiay inertiaz\n\
                dump d all local 1 body.txt c_b[*]\ndump_modify d format line \"%.15g %.15g %.15g %.15g %.15g\"\n\
                dump a all custom 1 atoms.txt id x y z radius\ndump_modify a format float %.15g sort id\nrun 2\n";
    std::fs::write(folder.path().join("in.body"), deck).unwrap();
    let program = std::env::var("LAMMPS")
        .expect("the variable names the command: trials/programs.sh body-files");
    run(folder.path(), &program, &["-in", "in.body"]);
    let body = std::fs::read_to_string(folder.path().join("body.txt")).unwrap();
    let [_, mass, mut found @ ..]: [f64; 5] = numbers(body.lines().last().unwrap());
    assert!((mass / MASS - 1.0).abs() < 1e-9, "{mass}");
    found.sort_by(f64::total_cmp);
    for (found, expected) in found.iter().zip(moments(&json).0) {
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    }
    let found = dumped(&folder.path().join("atoms.txt"));
    hold(&found, &spheres(folder.path()), 1e-9);
}

/// YADE takes the file as twelve spheres and as one clump, to 1e-9. It integrates mass and moments of the union on a grid of
/// its own: 1 %; the surface method gives the union the volume of the mesh, and its moments to 0.3 %.
#[test]
#[ignore = "needs YADE: trials/programs.sh body-files"]
fn yade_reads_its_table() {
    let folder = tempfile::tempdir().unwrap();
    let json = seed(folder.path(), "yade");
    let script = "from yade import ymport\n\
                  O.bodies.append(ymport.text('seed.yade'))\n\
                  for b in O.bodies: print('sphere', *['%.17g' % v for v in (*b.state.pos, b.shape.radius)])\n\
                  O.reset()\n\
                  clumps = ymport.textClumps('seed.yade', discretization=100)\n\
                  members = [b for b in O.bodies if b.isClumpMember]\n\
                  print('clumps', len(clumps), len(members))\n\
                  c = [b for b in O.bodies if b.isClump][0].state\n\
                  print('clump', c.mass / O.materials[0].density, *c.inertia / c.mass)\n";
    std::fs::write(folder.path().join("read.py"), script).unwrap();
    let told = run(folder.path(), "yade", &["-n", "-x", "-j1", "read.py"]);
    let lines = told.lines().filter_map(|line| line.strip_prefix("sphere "));
    hold(
        &lines.map(numbers).collect::<Vec<_>>(),
        &spheres(folder.path()),
        1e-9,
    );
    assert_eq!(after(&told, "clumps ").trim(), "1 12");
    let [volume, mut found @ ..]: [f64; 4] = numbers(after(&told, "clump "));
    let mesh = json["mesh"]["volume_mm3"].as_f64().unwrap() * 1e-9;
    assert!((volume / mesh - 1.0).abs() < 0.01, "{volume} {mesh}");
    found.sort_by(f64::total_cmp);
    for (found, expected) in found.iter().zip(moments(&json).0) {
        assert!((found * MASS / expected - 1.0).abs() < 0.01, "{found}");
    }
}

/// VTK, which is what `ParaView` reads with, finds the points, their radii and a vertex for each, to the last digit.
#[test]
#[ignore = "needs VTK for Python: trials/programs.sh body-files"]
fn vtk_reads_its_points() {
    let folder = tempfile::tempdir().unwrap();
    seed(folder.path(), "vtk");
    let script = "from vtkmodules.vtkIOLegacy import vtkPolyDataReader\n\
                  reader = vtkPolyDataReader()\nreader.SetFileName('seed.vtk')\nreader.Update()\n\
                  data = reader.GetOutput()\nradius = data.GetPointData().GetArray('radius')\n\
                  for i in range(data.GetNumberOfPoints()): print('sphere', *data.GetPoint(i), radius.GetValue(i))\n\
                  print('vertices', data.GetNumberOfVerts())\n";
    std::fs::write(folder.path().join("read.py"), script).unwrap();
    let program = std::env::var("VTK_PYTHON")
        .expect("the variable names a Python with VTK: trials/programs.sh body-files");
    let told = run(folder.path(), &program, &["read.py"]);
    assert_eq!(after(&told, "vertices ").trim(), "12");
    let lines = told.lines().filter_map(|line| line.strip_prefix("sphere "));
    let found = lines.map(|line| numbers(line).map(|mm: f64| 1e-3 * mm));
    for (found, expected) in found.zip(spheres(folder.path())) {
        assert_eq!(found, expected);
    }
}
