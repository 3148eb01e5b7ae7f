//! Beds in space: the seeds of the runs of the check where they lay in the last frame.

use super::photographs::{SPHERE_COLOUR, picture_error, png_bytes};
use super::run_charts::check_runs;
use crate::run_details::{RunDetails, Seeds};
use crate::{Error, ReportInput};
use frame_render::{ObjectView, RenderSphere, render_object};
use nalgebra::{UnitQuaternion, Vector3};
use report::{ViewerBody, ViewerKind, ViewerSphere};
use scene::{Apparatus, Drum};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Colours of the kinds of seeds in turn, sRGB.
const COLOURS: [[u8; 3]; 4] = [
    SPHERE_COLOUR,
    [112, 154, 186],
    [150, 176, 112],
    [190, 130, 150],
];
/// Colour of the rims of a drum.
const RIM_COLOUR: [u8; 3] = [120, 120, 120];
/// Beads that a rim is strung of, each with its middle on the surface of the next.
const BEADS: u32 = 800;
/// Width of the picture, pixels.
const PIXELS: u32 = 480;

/// A bed, z upwards, y away from the camera of the scene.
#[derive(Debug)]
pub(crate) struct Bed {
    /// Kinds of seeds, and the rims of the drum.
    pub(crate) kinds: Vec<ViewerKind>,
    /// Seeds, and rims.
    pub(crate) bodies: Vec<ViewerBody>,
}

/// The bed of the first run of each model of the check that kept it, by the number of the model.
pub(crate) fn beds(input: &ReportInput<'_>) -> Vec<(usize, Bed)> {
    let mut found = Vec::new();
    for (number, (model, records)) in check_runs(input).into_iter().enumerate() {
        let mut seeds = records.iter().filter_map(|r| RunDetails::of(r).seeds);
        if let Some(seeds) = seeds.next() {
            let drum = input
                .scenes
                .get(&model.name)
                .and_then(|scene| match &scene.apparatus {
                    Apparatus::Drum(drum) => Some(drum),
                    _ => None,
                });
            found.push((number, Bed::of(seeds, drum)));
        }
    }
    found
}

impl Bed {
    /// The seeds, in the rims of their drum if there is one.
    fn of(seeds: Seeds, drum: Option<&Drum>) -> Self {
        let coloured = seeds.kinds.into_iter().zip(COLOURS.into_iter().cycle());
        let mut bed = Self {
            kinds: coloured
                .map(|(spheres, colour)| ViewerKind { spheres, colour })
                .collect(),
            bodies: seeds.bodies,
        };
        if let Some(drum) = drum {
            bed.add_rims(0.5 * drum.inner_diameter.si(), 0.5 * drum.width.si());
        }
        // In a scene y is upwards, and the camera looks along -z.
        let upright = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), FRAC_PI_2);
        for body in &mut bed.bodies {
            body.position = upright * body.position;
            body.orientation = upright * body.orientation;
        }
        bed
    }

    /// Adds the ends of a shell as two rings about the z axis, strung of beads outside of it.
    fn add_rims(&mut self, radius: f64, half_width: f64) {
        let between = TAU / f64::from(BEADS);
        let bead = between * radius;
        let spheres = (0..BEADS).map(|number| {
            let (sin, cos) = (between * f64::from(number)).sin_cos();
            ViewerSphere {
                centre: [(radius + bead) * cos, (radius + bead) * sin, 0.0],
                radius: bead,
            }
        });
        let kind = self.kinds.len();
        self.kinds.push(ViewerKind {
            spheres: spheres.collect(),
            colour: RIM_COLOUR,
        });
        for end in [-half_width, half_width] {
            self.bodies.push(ViewerBody {
                position: Vector3::new(0.0, 0.0, end),
                ..ViewerBody::at_origin(kind)
            });
        }
    }

    /// Its picture as PNG, shown unless the viewer runs.
    pub(crate) fn picture(&self) -> Result<Vec<u8>, Error> {
        let view = ObjectView::oblique(PIXELS);
        let wrong = |e: frame_render::Error| picture_error("bed", &e.to_string());
        let picture = render_object(&self.spheres(), &[], &view).map_err(wrong)?;
        png_bytes("bed", &picture)
    }

    /// All spheres where they lie.
    fn spheres(&self) -> Vec<RenderSphere> {
        let mut all = Vec::new();
        for body in &self.bodies {
            let kind = &self.kinds[body.kind];
            all.extend(kind.spheres.iter().map(|s| RenderSphere {
                centre: (body.position + body.orientation * Vector3::from(s.centre)).into(),
                radius: s.radius,
                colour: kind.colour,
            }));
        }
        all
    }
}
