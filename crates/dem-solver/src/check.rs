//! What is refused at the door of a world.

use crate::bodies::Placement;
use crate::error::Error;
use crate::interaction::Interaction;
use crate::settings::Settings;
use crate::template::Template;
use crate::wall::{Shape, Wall};
use nalgebra::Vector3;

/// Checks that the settings are positive and finite.
pub(crate) fn settings(settings: &Settings) -> Result<(), Error> {
    let checks = [
        ("time step in s", settings.time_step),
        ("skin in m", settings.skin),
        ("margin in m", settings.margin),
    ];
    for (name, value) in checks {
        if !value.is_finite() || value <= 0.0 {
            return Err(Error::NotPositive { name, value });
        }
    }
    finite(&settings.gravity, || "gravity in m/s²".into())
}

/// Checks the table of interactions and returns the number of materials.
pub(crate) fn interactions(
    interactions: &[Interaction],
    templates: &[Template],
    walls: &[Wall],
) -> Result<usize, Error> {
    let n = interactions.len().isqrt();
    if n * n != interactions.len() {
        return Err(Error::Interactions {
            got: interactions.len(),
            expected: (n + 1) * (n + 1),
        });
    }
    let bodies = templates.iter().map(|t| t.material);
    if let Some(index) = bodies
        .chain(walls.iter().map(|w| w.material))
        .find(|&m| m >= n)
    {
        return Err(Error::NoSuch {
            what: "material",
            index,
            count: n,
        });
    }
    // Which of two bodies comes first is chance, so the table must not depend on it. A wall
    // always comes second.
    for a in templates.iter().map(|t| t.material) {
        for b in templates.iter().map(|t| t.material) {
            if interactions[a * n + b] != interactions[b * n + a] {
                return Err(Error::OneSidedInteraction { a, b });
            }
        }
    }
    Ok(n)
}

/// Checks that each sphere of each template has an index, and that the liquid on it is a volume.
pub(crate) fn templates(templates: &[Template]) -> Result<(), Error> {
    let no_volume = |liquid: &f64| !(liquid.is_finite() && *liquid >= 0.0);
    if let Some(value) = templates.iter().map(|t| t.liquid).find(no_volume) {
        let name = "volume of liquid on a body in m³, 0 where it is dry,";
        return Err(Error::NotPositive { name, value });
    }
    let most = usize::from(u16::MAX);
    match templates
        .iter()
        .map(Template::n_outer_spheres)
        .find(|&count| count > most)
    {
        Some(count) => Err(Error::TooManySpheres { count }),
        None => Ok(()),
    }
}

/// Checks the numbers of a wall.
pub(crate) fn wall(wall: &Wall) -> Result<(), Error> {
    let name = || format!("wall '{}'", wall.name);
    let broken = |rule| {
        Err(Error::Shape {
            wall: wall.name.clone(),
            rule,
        })
    };
    finite(&Vector3::z().scale(wall.spin), || {
        format!("{}: spin in rad/s", name())
    })?;
    match &wall.shape {
        Shape::Cylinder { radius } => {
            if !radius.is_finite() || *radius <= 0.0 {
                return broken("the radius must be a positive number of m");
            }
        }
        Shape::Plane { point, normal } => {
            finite(point, || format!("{}: point in m", name()))?;
            // A rounded unit vector is meant; the length enters the overlap as a factor.
            if (normal.norm() - 1.0).abs() > 1e-9 || !normal.norm().is_finite() {
                return broken("the normal must have length 1");
            }
        }
        Shape::Rectangle {
            centre,
            half_edges: [a, b],
        } => {
            finite(centre, || format!("{}: centre in m", name()))?;
            finite(&(a + b), || format!("{}: half edges in m", name()))?;
            let area = a.norm() * b.norm();
            if area <= 0.0 || a.dot(b).abs() > 1e-9 * area {
                return broken("the half edges must be longer than 0 and perpendicular");
            }
        }
    }
    if wall.spin != 0.0 && !wall.is_axisymmetric() {
        return Err(Error::SpinningShape {
            wall: wall.name.clone(),
        });
    }
    Ok(())
}

/// Checks where body number `body` starts.
pub(crate) fn placement(body: usize, placement: &Placement, walls: &[Wall]) -> Result<(), Error> {
    finite(&placement.position, || {
        format!("position of body {body} in m")
    })?;
    finite(&placement.velocity, || {
        format!("velocity of body {body} in m/s")
    })?;
    finite(&placement.spin, || format!("spin of body {body} in rad/s"))?;
    if !placement.orientation.coords.iter().all(|c| c.is_finite()) {
        return Err(Error::NotFinite {
            what: format!("orientation of body {body}"),
        });
    }
    for wall in walls {
        let depth = -wall.distance(&placement.position);
        if depth > 0.0 {
            return Err(Error::BehindWall {
                body,
                wall: wall.name.clone(),
                depth,
            });
        }
    }
    Ok(())
}

/// Refuses a vector with a component that is not a finite number.
fn finite(vector: &Vector3<f64>, what: impl Fn() -> String) -> Result<(), Error> {
    if vector.iter().all(|c| c.is_finite()) {
        Ok(())
    } else {
        Err(Error::NotFinite { what: what() })
    }
}
