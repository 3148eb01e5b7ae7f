//! The moments in the files that a program left: dumps among other files, the first of which may be written before any seed is
//! there.

use crate::exchange::{Moment, read_positions};
use crate::external_simulator::drum::in_order;
use crate::external_simulator::file_pattern::matching;
use crate::external_simulator::process::Failure;
use input::file::is_hidden;
use std::path::{Path, PathBuf};

/// What the files hold.
#[derive(Debug)]
pub(crate) struct LeftMoments {
    /// The moments in their order, none of them empty.
    pub(crate) moments: Vec<Moment>,
    /// What the user should know of the files.
    pub(crate) remarks: Vec<String>,
}

/// A moment with the place of its file in the list.
struct Found {
    moment: Moment,
    /// The place.
    file: usize,
}

impl LeftMoments {
    /// Reads the files that a path with `*` in its last part means. Files of other kinds (restarts, meshes, boxes of the domain,
    /// hidden files) are left out and counted; moments without a sphere before all others are part of the start-up.
    ///
    /// # Errors
    ///
    /// No file with positions, a broken one, a moment without a sphere behind one with spheres; the file is named.
    pub(crate) fn read(folder: &Path, pattern: &Path) -> Result<Self, Failure> {
        let files = matching(folder, pattern)?;
        let (mut found, mut others) = (Vec::new(), Vec::new());
        for (place, file) in files.iter().enumerate() {
            if is_hidden(file) {
                others.push((file, String::new()));
                continue;
            }
            match read_positions(file) {
                Ok(moments) => found.extend(moments.into_iter().map(|moment| Found {
                    moment,
                    file: place,
                })),
                Err(error) if error.is_other_kind() => others.push((file, error.to_string())),
                Err(error) => return Err(error.to_string()),
            }
        }
        if found.is_empty() {
            let why = others
                .iter()
                .map(|(_, why)| why)
                .find(|why| !why.is_empty());
            let why = why.map_or_else(String::new, |why| format!("; the first says: {why}"));
            return Err(format!(
                "none of the {} files of {} holds positions of spheres{why}",
                files.len(),
                folder.join(pattern).display()
            ));
        }
        let moments = in_order(without_start(found, &files)?)?;
        let remarks = others.first().map(|(first, _)| {
            format!(
                "{} of {} files hold no positions and are left out, such as {}",
                others.len(),
                files.len(),
                first.file_name().unwrap_or_default().display()
            )
        });
        Ok(Self {
            moments,
            remarks: remarks.into_iter().collect(),
        })
    }
}

/// The moments without those before the first sphere appears.
fn without_start(found: Vec<Found>, files: &[PathBuf]) -> Result<Vec<Moment>, Failure> {
    let filled = || found.iter().filter(|f| !f.moment.spheres.is_empty());
    if filled().next().is_none() {
        return Err("no moment of the positions holds a sphere: were any seeds put in?".into());
    }
    // Where some file tells no time, as an empty table, the order of the names counts.
    let by_time = found.iter().all(|f| f.moment.time.is_some());
    let by_step = found.iter().all(|f| f.moment.step.is_some());
    let order = |f: &Found| match (f.moment.time, f.moment.step) {
        (Some(time), _) if by_time => time,
        (_, Some(step)) if by_step => step as f64,
        _ => f.file as f64,
    };
    let first = filled().map(order).fold(f64::INFINITY, f64::min);
    let late = found
        .iter()
        .find(|f| f.moment.spheres.is_empty() && order(f) >= first);
    if let Some(late) = late {
        let step = late.moment.step;
        let step = step.map_or_else(String::new, |step| format!(" at step {step}"));
        return Err(format!(
            "{}: no sphere is left{step}, though earlier moments have some: look for spheres that were lost",
            files
                .get(late.file)
                .map_or(Path::new(""), PathBuf::as_path)
                .display()
        ));
    }
    let filled = found.into_iter().map(|f| f.moment);
    Ok(filled.filter(|m| !m.spheres.is_empty()).collect())
}

#[cfg(test)]
mod tests {
    use super::LeftMoments;
    use std::path::Path;

    /// A dump of a step with so many spheres.
    fn dump(step: usize, n: usize) -> String {
        let rows: Vec<String> = (0..n).map(|k| format!("{k} 0.0{k} 0 0 0.003\n")).collect();
        let rows = rows.concat();
        format!(
            "ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{n}\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\n\
             ITEM: ATOMS id x y z radius \n{rows}"
        )
    }

    const MESH: &str = "# vtk DataFile Version 2.0\nmesh\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 3 float\n\
        0 0 0 1 0 0 0 1 0\nCELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n5\n";
    const BOX: &str = "# vtk DataFile Version 2.0\nbox\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 2 2 2\n\
        X_COORDINATES 2 float\n0 1\nY_COORDINATES 2 float\n0 1\nZ_COORDINATES 2 float\n0 1\n";

    /// A folder as LIGGGHTS leaves it: the first dump, before the insertion, has no sphere, and restarts, meshes and boxes lie
    /// beside the dumps. The dumps alone are read.
    #[test]
    fn dumps_are_found_among_other_files() {
        let folder = tempfile::tempdir().unwrap();
        let write =
            |name: &str, text: &[u8]| std::fs::write(folder.path().join(name), text).unwrap();
        for (step, n) in [(0, 0), (500, 0), (1000, 4), (1500, 4)] {
            write(&format!("bed_{step}.liggghts"), dump(step, n).as_bytes());
        }
        for (name, text) in [
            ("bed_0.restart", &b"\x00\x01\xff\xfe binary"[..]),
            (".gitkeep", b""),
            ("drum_0.vtk", MESH.as_bytes()),
            ("bed_boundingBox.vtk", BOX.as_bytes()),
            ("drum.stl", b"solid drum\nendsolid drum\n"),
            ("energy.csv", b"step,energy\n0,1\n"),
            ("force_0.dump", b"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ENTRIES\n0\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\nITEM: ENTRIES c_1\n"),
        ] {
            write(name, text);
        }
        let read = LeftMoments::read(folder.path(), Path::new("*")).unwrap();
        let steps: Vec<_> = read.moments.iter().map(|m| m.step).collect();
        assert_eq!(steps, [Some(1000), Some(1500)]);
        assert!(
            read.remarks[0].starts_with("7 of 11 files"),
            "{:?}",
            read.remarks
        );
        // A broken dump does not count as a file of another kind.
        write("bed_2000.liggghts", &dump(2000, 4).as_bytes()[..150]);
        let broken = LeftMoments::read(folder.path(), Path::new("*")).unwrap_err();
        assert!(broken.contains("bed_2000.liggghts"), "{broken}");
        // Nor is one that is empty: the program ended while it wrote.
        write("bed_2000.liggghts", b"");
        let broken = LeftMoments::read(folder.path(), Path::new("*")).unwrap_err();
        assert!(broken.contains("bed_2000.liggghts"), "{broken}");
    }

    #[test]
    fn a_bed_that_is_gone_is_reported_with_its_file() {
        let folder = tempfile::tempdir().unwrap();
        for (step, n) in [(0, 0), (1000, 4), (1500, 0), (2000, 4)] {
            std::fs::write(folder.path().join(format!("b{step}.dump")), dump(step, n)).unwrap();
        }
        let gone = LeftMoments::read(folder.path(), Path::new("b*.dump")).unwrap_err();
        assert!(
            gone.contains("b1500.dump") && gone.contains("step 1500"),
            "{gone}"
        );
        let other = tempfile::tempdir().unwrap();
        std::fs::write(other.path().join("drum.stl"), "solid drum\n").unwrap();
        let none = LeftMoments::read(other.path(), Path::new("*")).unwrap_err();
        assert!(
            none.contains("none of the 1 files") && none.contains("drum.stl"),
            "{none}"
        );
    }

    /// Tables of YADE and VTK files may begin with one that holds no sphere either.
    #[test]
    fn the_first_table_may_be_empty() {
        let folder = tempfile::tempdir().unwrap();
        let write =
            |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("bed_0.csv", "time_s,x_m,y_m,z_m,radius_m\n");
        for k in 1..3 {
            write(
                &format!("bed_{k}.csv"),
                &format!("time_s,x_m,y_m,z_m,radius_m\n0.{k},0,0,0,0.003\n"),
            );
        }
        let read = LeftMoments::read(folder.path(), Path::new("*.csv")).unwrap();
        assert_eq!(read.moments.len(), 2);
        let vtk = |n: usize| {
            let rest = if n == 0 {
                ""
            } else {
                "POINT_DATA 1\nSCALARS radius float 1\nLOOKUP_TABLE default\n0.003\n"
            };
            format!(
                "# vtk DataFile Version 3.0\nbed\nASCII\nDATASET POLYDATA\nPOINTS {n} float\n{}{rest}",
                "0 0 0\n".repeat(n)
            )
        };
        for (k, n) in [(0, 0), (1, 1), (2, 1)] {
            write(&format!("bed_{k}.vtk"), &vtk(n));
        }
        let read = LeftMoments::read(folder.path(), Path::new("*.vtk")).unwrap();
        assert_eq!(read.moments.len(), 2);
    }
}
