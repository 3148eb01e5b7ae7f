//! A frame as a picture to look at: drums as their camera sees them, heaps and boxes from the side, other apparatus in section.

use crate::obstacles::walls_in_frame;
use crate::{Apparatus, DrumCamera, Error, Frame, PouredHeap, Scene, SeedBody};
use dem_solver::Shape;
use frame_render::{RenderSphere, SideView, render_side, seed_colour};
use image::{DynamicImage, RgbImage};
use input::quantity::Angle;
use nalgebra::{UnitQuaternion, Vector3};
use photo_profile::{MAX_ANGLE_ERROR, Mode, PhotoPixels, PhotoReading, Settings, measure_photo};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

/// Share of the seeds on either side that do not count for the width of a picture: of a low heap a tenth may roll far.
const STRAYED: f64 = 0.1;
/// Width that is seen over that between those places: 1.35 times a cone, whose tenths lie at 0.45 of its radius, so that the
/// floor shows beside it.
const MARGIN: f64 = 3.0;
/// Farthest of those places from the middle of what was let go, over half of its width: a heap of 15 degrees of a cylinder three times
/// as high as wide has four times the radius of the cylinder, and its tenths lie at 1.8. Where many seeds roll away, the heap and the
/// seeds about it are seen and not an empty floor.
const FARTHEST: f64 = 3.0;
/// Height of the floor over the lower border of the picture, over half of the width that is seen.
const FLOOR: f64 = 0.3;

/// Corners of a triangle, m.
type Corners = [[f64; 3]; 3];

/// Picture of a frame; `None` for a bench test, which has no bed.
///
/// In a drum with walls of triangles these are drawn too. The angle is read from the picture without them
/// ([`crate::drum_picture`]), since a reader cannot tell them from seeds.
///
/// # Errors
///
/// A view that cannot be drawn, a wall whose mesh can no longer be read.
pub fn frame_picture(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    frame: &Frame,
) -> Result<Option<RgbImage>, Error> {
    if scene.apparatus.is_bench_test() {
        return Ok(None);
    }
    if scene.apparatus.has_phases() && !scene.apparatus.device().leaves_a_heap() {
        return in_section(scene, bodies, frame).map(Some);
    }
    // Of a released heap, what held it is out of the way or hides it.
    let is_heap = scene.apparatus.has_phases();
    let placed = walls_in_frame(scene, frame)?;
    let seen = placed.iter().filter(|wall| !(is_heap && wall.is_own));
    let walls: Vec<Corners> = seen.flat_map(|wall| &wall.triangles).map(drawn).collect();
    if is_heap {
        return from_the_side(scene, bodies, frame, walls).map(Some);
    }
    let camera = DrumCamera::of(scene);
    camera
        .picture_with_walls(frame.spheres(bodies), &walls)
        .map(Some)
}

/// Inclinations of the flanks of a round heap by the reader of photos, rad, in pictures along z and x; fewer if one cannot be read.
pub(crate) fn heap_angles(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    frame: &Frame,
) -> Result<Vec<f64>, Error> {
    let largest = scene.camera.max_angle_error;
    let settings = Settings {
        mode: Mode::Heap,
        max_angle_error: largest.map_or(MAX_ANGLE_ERROR, Angle::si),
        ..Settings::default()
    };
    let aside = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), FRAC_PI_2);
    let mut angles = Vec::new();
    for turn in [UnitQuaternion::identity(), aside] {
        let turned = Frame {
            position: frame.position.iter().map(|p| turn * p).collect(),
            orientation: frame.orientation.iter().map(|q| turn * q).collect(),
            ..frame.clone()
        };
        let picture = from_the_side(scene, bodies, &turned, Vec::new())?;
        let pixels = PhotoPixels::from_picture(&DynamicImage::from(picture));
        // A heap that the reader of photos refuses has no angle, as on a photo.
        if let Ok(PhotoReading::Heap(heap)) = measure_photo(&pixels, &settings) {
            angles.extend([heap.left, heap.right]);
        }
    }
    Ok(angles)
}

/// The inside of an apparatus: seeds, and the half of the walls behind the axis.
fn in_section(scene: &Scene, bodies: &[Arc<SeedBody>], frame: &Frame) -> Result<RgbImage, Error> {
    let device = scene.apparatus.device();
    let behind = |corners: &&[Vector3<f64>; 3]| corners.iter().map(|c| c.z).sum::<f64>() <= 0.0;
    let placed = walls_in_frame(scene, frame)?;
    let behind = placed
        .iter()
        .flat_map(|wall| &wall.triangles)
        .filter(behind);
    let mut walls: Vec<Corners> = behind.map(drawn).collect();
    for wall in device.walls() {
        if let Shape::Rectangle {
            centre,
            half_edges: [a, b],
        } = wall.shape
        {
            let corners = [-a - b, a - b, a + b, b - a].map(|c| <[f64; 3]>::from(centre + c));
            let [a, b, c, d] = corners;
            walls.extend([[a, b, c], [a, c, d]]);
        }
    }
    let [low, high] = device.view();
    let spheres = frame.spheres(bodies).map(|(body, s)| RenderSphere {
        centre: s.centre.into(),
        radius: s.radius,
        colour: seed_colour(body),
    });
    let middle = 0.5 * (low + high);
    let half = 0.5 * (high - low);
    let view = SideView {
        centre: [middle.x, middle.y, 0.0],
        half_width: 1.1 * half.x.max(half.y),
        depth: 2.0 * half.norm(),
        pixels: scene.camera.pixels,
    };
    Ok(render_side(&spheres.collect::<Vec<_>>(), &walls, &view)?)
}

/// The corners of a triangle for the picture.
fn drawn(corners: &[Vector3<f64>; 3]) -> Corners {
    corners.map(Into::into)
}

/// A heap or a box from the side.
fn from_the_side(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    frame: &Frame,
    mut walls: Vec<Corners>,
) -> Result<RgbImage, Error> {
    let sorted = |of: fn(&Vector3<f64>) -> f64| {
        let mut all: Vec<f64> = frame.position.iter().map(of).collect();
        all.sort_by(f64::total_cmp);
        all
    };
    let quantile = |all: &[f64], share: f64| {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a place in the list"
        )]
        let place = (share * all.len().saturating_sub(1) as f64).round() as usize;
        all.get(place).copied().unwrap_or(0.0)
    };
    let (along, heights) = (sorted(|p| p.x), sorted(|p| p.y));
    let size = bodies.iter().map(|b| b.clump.bounding_radius());
    let size = size.fold(0.0, f64::max);
    let is_box = matches!(scene.apparatus, Apparatus::BoxCollapse(_));
    let half = scene.apparatus.radius();
    let middle = if is_box { half } else { 0.0 };
    let seen = |share: f64| {
        let place = quantile(&along, share) - middle;
        middle + place.clamp(-FARTHEST * half, FARTHEST * half)
    };
    let mut left = seen(STRAYED) - size;
    if is_box {
        left = left.min(0.0);
    }
    let right = seen(1.0 - STRAYED) + size;
    let top = quantile(&heights, 1.0) + size;
    let half_width = (0.5 * MARGIN * (right - left)).max(0.6 * top);
    let middle = 0.5 * (left + right);
    let reach = frame.position.iter().map(|p| p.z.abs() + size);
    let reach = reach.fold(size, f64::max);
    // Floor and back of a box stand as slabs, behind nothing.
    let mut slab = |[x0, x1]: [f64; 2], [y0, y1]: [f64; 2]| {
        let [a, b, c, d] = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(|[x, y]| [x, y, reach]);
        walls.extend([[a, b, c], [a, c, d]]);
    };
    let floor = match &scene.apparatus {
        Apparatus::PouredHeap(PouredHeap {
            disc: Some(disc), ..
        }) => [-0.5 * disc.si(), 0.5 * disc.si()],
        _ => [middle - half_width, middle + half_width],
    };
    slab(floor, [-FLOOR * half_width, 0.0]);
    if let Apparatus::BoxCollapse(body) = &scene.apparatus {
        slab([middle - half_width, 0.0], [0.0, body.height.si()]);
    }
    let seen = frame.spheres(bodies).map(|(body, s)| RenderSphere {
        centre: s.centre.into(),
        radius: s.radius,
        colour: seed_colour(body),
    });
    let view = SideView {
        centre: [middle, (1.0 - FLOOR) * half_width, 0.0],
        half_width,
        depth: 2.0 * reach,
        pixels: scene.camera.pixels,
    };
    Ok(render_side(&seen.collect::<Vec<_>>(), &walls, &view)?)
}

#[cfg(test)]
mod tests {
    use super::frame_picture;
    use crate::{FillingLibrary, Frame, Scene};
    use dem_solver::MeshPose;
    use image::{DynamicImage, RgbImage};
    use nalgebra::{UnitQuaternion, Vector3};
    use photo_profile::{Mode, PhotoPixels, PhotoReading, Settings, measure_photo};
    use std::f64::consts::FRAC_PI_2;

    /// Balls of 2 mm in an apparatus, with further sections.
    fn scene(apparatus: &str, more: &str) -> Scene {
        let text = format!(
            r#"
            apparatus = {apparatus}
            seed = [{{ name = "ball", sphere = "2 mm", density = "1250 kg/m3", count = 9, material = "a" }}]
            material.a = {{ poisson_ratio = 0.3, shear_modulus = "5 MPa" }}
            contact.a-a = {{ restitution = 0.5, static_friction = 0.4 }}
            {more}
            "#
        );
        let folder = dev_support::fixture_files::fixture("stl");
        Scene::from_text(&text, "any.toml", &folder, &[]).unwrap()
    }

    /// A wall that has not moved.
    fn at_rest() -> MeshPose {
        MeshPose {
            about: Vector3::zeros(),
            displacement: Vector3::zeros(),
            turn: UnitQuaternion::identity(),
            removed: false,
        }
    }

    /// Whether the colour of walls is seen at a place of a picture, pixels.
    fn is_wall(picture: &RgbImage, [x, y]: [u32; 2]) -> bool {
        let [r, _, b] = picture.get_pixel(x, y).0;
        b > r + 20
    }

    /// The picture of balls at these places, and of walls.
    fn picture(scene: &Scene, places: Vec<Vector3<f64>>, walls: Vec<MeshPose>) -> Option<RgbImage> {
        let body = FillingLibrary::default().body(scene, &scene.seed[0]);
        let n = places.len();
        let frame = Frame {
            time: 0.0,
            kind: vec![0; n],
            position: places,
            orientation: vec![UnitQuaternion::identity(); n],
            velocity: vec![Vector3::zeros(); n],
            spin: vec![Vector3::zeros(); n],
            walls,
        };
        frame_picture(scene, &[body.unwrap()], &frame).unwrap()
    }

    const HEAP: &str = r#"{ kind = "heap", inner_diameter = "40 mm", height = "60 mm", lift_speed = "50 mm/s", floor = "a",
        cylinder = "a" }"#;

    /// Balls of 2 mm on a cone of 30 degrees, 60 mm high, a few of them or a third far away on the floor: the reader of photos finds both
    /// flanks; a degree is the roughness of balls of a thirtieth of the height.
    #[test]
    fn a_heap_is_drawn_so_that_its_slope_can_be_read() {
        for strays in [20, 4000] {
            heap_with(strays);
        }
    }

    /// Draws the heap with so many seeds on either side that rolled away, and reads its slope.
    fn heap_with(strays: u32) {
        let slope = 30_f64.to_radians().tan();
        let grid = || (-70..=70_i32).flat_map(|i| (-70..=70_i32).map(move |j| (i, j)));
        let on_cone = grid().filter_map(|(i, j)| {
            let (x, z) = (1.5e-3 * f64::from(i), 1.5e-3 * f64::from(j));
            let y = 0.06 - slope * x.hypot(z);
            (y > 0.001).then_some(Vector3::new(x, y, z))
        });
        let strays = (0..2 * strays).map(|k| {
            let side = if k % 2 == 0 { 1.0 } else { -1.0 };
            Vector3::new(side, 0.001, 1e-3 * f64::from(k))
        });
        let places: Vec<_> = on_cone.chain(strays).collect();
        let drawn = picture(&scene(HEAP, ""), places, Vec::new()).unwrap();
        let pixels = PhotoPixels::from_picture(&DynamicImage::from(drawn));
        let settings = Settings {
            mode: Mode::Heap,
            ..Settings::default()
        };
        let PhotoReading::Heap(heap) = measure_photo(&pixels, &settings).unwrap() else {
            panic!("the heap is refused");
        };
        assert!(
            (heap.mean.to_degrees() - 30.0).abs() < 1.0,
            "{}",
            heap.mean.to_degrees()
        );
    }

    /// A box has its floor and its back; nothing is drawn of a bench test.
    #[test]
    fn a_box_stands_on_its_floor() {
        let text = r#"{ kind = "box-collapse", length = "40 mm", height = "60 mm", width = "20 mm", lift_speed = "1 m/s",
            floor = "a", wall = "a" }"#;
        let places = (0..40)
            .map(|k| Vector3::new(1e-3 * f64::from(k), 0.001, 0.0))
            .collect();
        let drawn = picture(&scene(text, ""), places, Vec::new()).unwrap();
        let is_wall = |x: u32, y: u32| is_wall(&drawn, [x, y]);
        assert!(
            is_wall(240, 470) && is_wall(5, 300),
            "floor below, back on the left"
        );
        assert!(
            !is_wall(240, 20) && !is_wall(470, 300),
            "air above and before"
        );
        let sled = scene(r#"{ kind = "slider", plate = "a" }"#, "");
        assert!(picture(&sled, Vec::new(), Vec::new()).is_none());
    }

    /// A ball of a mesh, 40 mm to the right of the axis of a drum, is drawn there if the frame does not know it, and above the axis
    /// once it has turned by a quarter. The angle is read from a picture without it.
    #[test]
    fn a_wall_is_drawn_where_it_has_moved() {
        let wall = r#"
            [[wall]]
            name = "ball"
            mesh = "sphere.stl"
            mesh_unit = "mm"
            material = "a"
            position = ["40 mm", "0 mm", "0 mm"]
        "#;
        let drum = r#"{ kind = "drum", inner_diameter = "120 mm", width = "30 mm", speed = "20 rpm", shell = "a",
            cover = "a" }"#;
        let scene = scene(drum, wall);
        let turned = MeshPose {
            turn: UnitQuaternion::from_axis_angle(&Vector3::z_axis(), FRAC_PI_2),
            ..at_rest()
        };
        for (walls, [x, y]) in [(Vec::new(), [0.04, 0.0]), (vec![turned], [0.0, 0.04])] {
            let drawn = picture(&scene, vec![Vector3::new(0.0, -0.05, 0.0)], walls).unwrap();
            let blue = |x: f64, y: f64| {
                let scale = 240.0 / (0.06 * 1.08);
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "a place in the picture"
                )]
                let at = [239.5 + scale * x, 239.5 - scale * y].map(|p| p as u32);
                is_wall(&drawn, at)
            };
            assert!(blue(x, y), "at {x} m, {y} m");
            assert!(!blue(y, x) && !blue(0.0, 0.0), "only at {x} m, {y} m");
        }
    }

    /// A level plate of a machine is a line at its height; lowered by 8 mm it is drawn there and not where it was, and taken away it is
    /// not drawn. The view is 40 mm high in 1.1 times 480 pixels.
    #[test]
    fn a_section_shows_a_plate_where_it_is() {
        let machine = r#"{ kind = "machine", room = [["-20 mm", "0 mm", "-20 mm"], ["20 mm", "40 mm", "20 mm"]],
            wall = [{ name = "plate", material = "a", shape.rectangle = { corner = ["-15 mm", "30 mm", "-15 mm"],
            edges = [["30 mm", "0 mm", "0 mm"], ["0 mm", "0 mm", "30 mm"]] } }], phase = [{ name = "rest", end.after = "1 s" }],
            probe = [{ name = "bed_g", reads.mass = {} }] }"#;
        let scene = scene(machine, "");
        let heights = |walls: Vec<MeshPose>| {
            let drawn = picture(&scene, vec![Vector3::new(0.0, 0.003, 0.0)], walls).unwrap();
            let height = |row: &u32| 0.02 + (239.5 - f64::from(*row)) / 240.0 * 0.022;
            let rows = (0..480_u32).filter(|row| is_wall(&drawn, [150, *row]));
            rows.map(|row| height(&row)).collect::<Vec<_>>()
        };
        let lowered = MeshPose {
            displacement: Vector3::y() * -0.008,
            ..at_rest()
        };
        let taken = MeshPose {
            removed: true,
            ..at_rest()
        };
        // Half the width of a line and half a pixel.
        let at =
            |seen: &[f64], y: f64| !seen.is_empty() && seen.iter().all(|h| (h - y).abs() < 0.00015);
        assert!(at(&heights(Vec::new()), 0.03));
        assert!(at(&heights(vec![lowered]), 0.022));
        assert!(heights(vec![taken]).is_empty());
    }
}
