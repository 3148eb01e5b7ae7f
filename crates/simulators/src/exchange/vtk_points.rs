//! Reading points from VTK files: legacy and XML, in ASCII.

use crate::exchange::Error;
use crate::exchange::moment::{BedSphere, Moment};
use geometry::clump::Sphere;
use nalgebra::Vector3;

/// Named arrays of a file of points, with the line in which each begins.
struct PointArrays<'a> {
    /// The file, for messages.
    file: &'a str,
    /// Name in small letters, number of components, line, values.
    arrays: Vec<(String, usize, usize, Vec<f64>)>,
    /// Whether the points are joined to lines, faces or cells, as those of a mesh are.
    has_faces: bool,
}

impl PointArrays<'_> {
    /// The moment of the arrays: `points`, `radius` or `diameter`, and `velocity` or `v`, `body` or `mol` where they
    /// are there.
    fn moment(&self) -> Result<Moment, Error> {
        let find = |names: &[&str], components: usize| {
            let mut all = self.arrays.iter();
            all.find(|a| names.contains(&a.0.as_str()) && a.1 == components)
                .map(|a| &a.3)
        };
        let missing = |what: &str| Error::Positions {
            file: self.file.to_owned(),
            line: 1,
            what: what.to_owned(),
        };
        let other = |what: &str| Error::OtherKind {
            file: self.file.to_owned(),
            what: what.to_owned(),
        };
        let points = find(&["points"], 3).ok_or_else(|| other("the file has no points"))?;
        let n = points.len() / 3;
        if n == 0 {
            return Ok(Moment::default());
        }
        let radii = find(&["radius"], 1).map(|radii| (radii, 1.0));
        let sizes = radii.or_else(|| Some((find(&["diameter"], 1)?, 0.5)));
        let (sizes, half) = sizes.ok_or_else(|| {
            let what = "there is no array 'radius' or 'diameter'";
            // A dump of spheres that ends too early has points alone.
            if self.has_faces {
                other(what)
            } else {
                missing(what)
            }
        })?;
        let velocities = find(&["velocity", "v"], 3);
        let bodies = find(&["body", "mol", "id_multisphere"], 1);
        let whole =
            |array: Option<&Vec<f64>>, each: usize| array.is_none_or(|a| a.len() == each * n);
        if !(whole(Some(sizes), 1) && whole(velocities, 3) && whole(bodies, 1)) {
            return Err(missing(
                "an array has another number of values than there are points",
            ));
        }
        let vector = |a: &Vec<f64>, k: usize| Vector3::new(a[3 * k], a[3 * k + 1], a[3 * k + 2]);
        let sphere = |k: usize| {
            let radius = half * sizes[k];
            if radius <= 0.0 {
                return Err(missing(&format!(
                    "point {k} has radius {radius}, it must be above 0"
                )));
            }
            Ok(BedSphere {
                body: bodies.map_or(k, |b| number_of_body(b[k])),
                sphere: Sphere {
                    centre: vector(points, k),
                    radius,
                },
                velocity: velocities.map(|v| vector(v, k)),
            })
        };
        Ok(Moment {
            step: None,
            time: None,
            spheres: (0..n).map(sphere).collect::<Result<_, _>>()?,
        })
    }

    /// Adds an array from the words of a text, `count` of them; gives the words that follow.
    fn add<'w>(
        &mut self,
        (name, components, line): (&str, usize, usize),
        count: usize,
        words: &'w [(usize, &'w str)],
    ) -> Result<&'w [(usize, &'w str)], Error> {
        let wrong = |line: usize, what: String| Error::Positions {
            file: self.file.to_owned(),
            line,
            what,
        };
        if words.len() < count {
            let what = format!(
                "array '{name}' ends after {} of {count} numbers",
                words.len()
            );
            return Err(wrong(line, what));
        }
        let (own, rest) = words.split_at(count);
        let numbers = own.iter().map(|(line, word)| {
            let value = word.parse().ok().filter(|x: &f64| x.is_finite());
            value.ok_or_else(|| wrong(*line, format!("{name} = '{word}' must be a finite number")))
        });
        let values = numbers.collect::<Result<Vec<f64>, Error>>()?;
        let name = name.to_ascii_lowercase();
        self.arrays.push((name, components, line, values));
        Ok(rest)
    }

    /// Adds the arrays of a FIELD from the words after its head, so many of them; gives the words that follow.
    fn add_field<'w>(
        &mut self,
        line: usize,
        arrays: usize,
        mut words: &'w [(usize, &'w str)],
    ) -> Result<&'w [(usize, &'w str)], Error> {
        for _ in 0..arrays {
            let at = |k: usize| words.get(k).map_or("", |(_, word)| *word);
            let size = |k: usize| {
                at(k).parse::<usize>().map_err(|_| Error::Positions {
                    file: self.file.to_owned(),
                    line,
                    what: "an array of a FIELD must state its size".into(),
                })
            };
            let (name, components, tuples) = (at(0), size(1)?, size(2)?);
            let values = words.get(4..).unwrap_or(&[]);
            let total = components.saturating_mul(tuples);
            words = self.add((name, components, line), total, values)?;
        }
        Ok(words)
    }
}

/// The number of a body from its value in an array; those below 0 count as 0.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "it chooses a colour and nothing else"
)]
fn number_of_body(value: f64) -> usize {
    value.max(0.0) as usize
}

/// The words of a text, each with its line from 1.
fn words_of(text: &str) -> Vec<(usize, &str)> {
    let lines = text.lines().enumerate();
    lines
        .flat_map(|(k, line)| line.split_whitespace().map(move |word| (k + 1, word)))
        .collect()
}

/// Reads a legacy VTK file of points in ASCII, as LIGGGHTS and YADE write it.
///
/// # Errors
///
/// A binary file, an array that ends early or is not a number, no points, no radius.
pub(crate) fn read_legacy(text: &str, file: &str) -> Result<Moment, Error> {
    let wrong = |line: usize, what: &str| Error::Positions {
        file: file.to_owned(),
        line,
        what: what.to_owned(),
    };
    if text.lines().nth(2).map(str::trim) != Some("ASCII") {
        let what = "the third line must be ASCII: write the file in ASCII form";
        return Err(wrong(3, what));
    }
    // The second line is a title, which may hold anything.
    let all = words_of(text);
    let mut words: &[(usize, &str)] = &all[all.partition_point(|(line, _)| *line < 4)..];
    let mut arrays = PointArrays {
        file,
        arrays: Vec::new(),
        has_faces: false,
    };
    let (mut n, mut of_points) = (0, true);
    while let [(line, keyword), rest @ ..] = words {
        let word = |k: usize| rest.get(k).map_or("", |(_, word)| *word);
        let after = |k: usize| rest.get(k..).unwrap_or(&[]);
        let count = |k: usize| {
            let number = word(k).parse::<usize>();
            number.map_err(|_| wrong(*line, &format!("a count must follow {keyword}")))
        };
        words = match *keyword {
            "POINTS" => {
                n = count(0)?;
                arrays.add(("points", 3, *line), n.saturating_mul(3), after(2))?
            }
            "POLYGONS" | "LINES" | "TRIANGLE_STRIPS" | "CELLS" => {
                arrays.has_faces = true;
                rest
            }
            "POINT_DATA" | "CELL_DATA" => {
                of_points = *keyword == "POINT_DATA";
                after(1)
            }
            "SCALARS" if of_points => {
                let components = count(2).unwrap_or(1);
                let table = rest.iter().position(|(_, w)| *w == "LOOKUP_TABLE");
                let values = after(table.map_or(2, |at| at + 2));
                let total = components.saturating_mul(n);
                arrays.add((word(0), components, *line), total, values)?
            }
            "VECTORS" if of_points => {
                arrays.add((word(0), 3, *line), n.saturating_mul(3), after(2))?
            }
            "FIELD" if of_points => arrays.add_field(*line, count(1)?, after(2))?,
            // Cells, and what belongs to them: numbers until the next keyword.
            _ => rest,
        };
    }
    arrays.moment()
}

/// Reads a VTK file of points in XML with arrays in ASCII, as [`crate::exchange::vtk::series`] writes it.
///
/// # Errors
///
/// Arrays in another form than ASCII, an array that is not a number, no points, no radius.
pub(crate) fn read_xml(text: &str, file: &str) -> Result<Moment, Error> {
    let mut arrays = PointArrays {
        file,
        arrays: Vec::new(),
        has_faces: false,
    };
    let (mut rest, mut line, mut is_points) = (text, 1, false);
    while let Some(at) = rest.find('<') {
        line += rest[..at].matches('\n').count();
        rest = &rest[at..];
        let Some(end) = rest.find('>') else { break };
        let (tag, after) = rest.split_at(end + 1);
        let attribute = |name: &str| {
            let (_, value) = tag.split_once(&format!("{name}=\""))?;
            value.split('"').next()
        };
        if ["<Polys", "<Lines", "<Strips"]
            .iter()
            .any(|of| tag.starts_with(of))
        {
            arrays.has_faces = true;
        }
        if tag.starts_with("<Points") {
            is_points = true;
        } else if tag.starts_with("</Points") {
            is_points = false;
        }
        rest = after;
        line += tag.matches('\n').count();
        if tag.starts_with("<DataArray") {
            if attribute("format") != Some("ascii") {
                return Err(Error::Positions {
                    file: file.to_owned(),
                    line,
                    what: "an array is not in ASCII: write the file in ASCII form".into(),
                });
            }
            let name = if is_points {
                "points"
            } else {
                attribute("Name").unwrap_or("")
            };
            let components = attribute("NumberOfComponents").and_then(|n| n.parse().ok());
            let components = components.unwrap_or(1);
            let content = rest.split('<').next().unwrap_or("");
            let words: Vec<(usize, &str)> = words_of(content)
                .into_iter()
                .map(|(k, word)| (line + k - 1, word))
                .collect();
            arrays.add((name, components, line), words.len(), &words)?;
        }
    }
    arrays.moment()
}

#[cfg(test)]
mod tests {
    use super::{read_legacy, read_xml};
    use crate::exchange::Moment;
    use crate::exchange::vtk::series;
    use dev_support::fixture_files::fixture;
    use scene::{FillingLibrary, Override, Scene, starting_frame};

    /// What is written for `ParaView` is read back: every sphere with place, size, motion and seed, to rounding of the text.
    #[test]
    fn a_frame_for_paraview_is_read_back() {
        let file = fixture("cotton/drum.toml");
        let set = |name: &str, value: &str| Override {
            name: name.into(),
            value: value.into(),
        };
        let few = [
            set("seed.0.count", "3"),
            set("seed.1.count", "2"),
            set("seed.0.filling.sphere_count", "20"),
            set("seed.1.filling.sphere_count", "20"),
        ];
        let scene = Scene::read(&file, &few).unwrap();
        let (mut frame, bodies, _) = starting_frame(&scene, &FillingLibrary::default(), 1).unwrap();
        frame.velocity[3].x = 0.125;
        let files = series("bed", &scene, std::slice::from_ref(&frame), &bodies).unwrap();
        let read = read_xml(&files[1].text, "bed.vtp").unwrap();
        let all = crate::exchange::fractions::fractions(&frame, &bodies);
        assert_eq!(read.spheres.len(), all.len());
        for (a, b) in read.spheres.iter().zip(&all) {
            assert_eq!(
                (a.body, a.sphere, a.velocity),
                (b.body, b.sphere, Some(b.velocity))
            );
        }
    }

    const LEGACY: &str = "# vtk DataFile Version 3.0\nGenerated by code 9 POINTS\nASCII\nDATASET POLYDATA\n\
        POINTS 2 float\n0 1 2 3 4 5\nVERTICES 2 4\n1 0\n1 1\nPOINT_DATA 2\nVECTORS v float\n1 0 0 0 1 0\n\
        SCALARS radius float 1\nLOOKUP_TABLE default\n0.5\n0.25\n";

    #[test]
    fn legacy_files_are_read_with_scalars_or_a_field() {
        let check = |moment: Moment| {
            let s = moment.spheres[1];
            assert_eq!((s.sphere.radius, s.sphere.centre.z), (0.25, 5.0));
            assert_eq!(s.velocity.unwrap().y, 1.0);
        };
        check(read_legacy(LEGACY, "bed.vtk").unwrap());
        let scalars = "SCALARS radius float 1\nLOOKUP_TABLE default\n0.5\n0.25\n";
        let field = "FIELD fields 2\nmass 1 2 float\n1 1\nradius 1 2 float\n0.5 0.25\n";
        check(read_legacy(&LEGACY.replace(scalars, field), "bed.vtk").unwrap());
    }

    #[test]
    fn what_cannot_be_read_is_told_with_its_line() {
        let told = |text: &str| read_legacy(text, "bed.vtk").unwrap_err().to_string();
        assert!(told(&LEGACY.replace("ASCII", "BINARY")).contains("line 3"));
        let message = told(&LEGACY.replace("3 4 5", "3 nan 5"));
        assert!(
            message.contains("line 6") && message.contains("'nan'"),
            "{message}"
        );
        let message = told(&LEGACY.replace("0.25\n", ""));
        assert!(message.contains("1 of 2 numbers"), "{message}");
        let message = told(&LEGACY.replace("radius", "mass"));
        assert!(message.contains("'radius' or 'diameter'"), "{message}");
    }

    /// A number of points whose coordinates are more than there are numbers for a computer to count: 3 n wraps to 2 here, and two
    /// numbers follow. The array ends too early all the same.
    #[test]
    fn more_points_than_can_be_counted_are_refused() {
        let n = usize::MAX / 3 + 1;
        let text = format!("# vtk\nbed\nASCII\nDATASET POLYDATA\nPOINTS {n} float\n0 0\n");
        let error = read_legacy(&text, "bed.vtk").unwrap_err().to_string();
        assert!(error.contains("'points' ends after 2"), "{error}");
    }
}
