//! Heap and box collapse: fill, settle, lift a wall, wait for rest, read the slope.

use crate::build::Built;
use crate::driven_pile::is_driven_by_rolling;
use crate::keeper::Keeper;
use crate::motion::{Progress, Running, SERIES_INTERVAL, advance, rest_energy, settle, snapshot};
use crate::outline::{FLANK, Outline, TOE, TOP, View};
use crate::phase_times::Stopwatch;
use crate::{Apparatus, Doubt, Error, Frame, ObservableValues, Scene, SeedBody};
use geometry::clump::Sphere;
use std::sync::Arc;

/// What the seeds look like when they rest again.
#[derive(Debug, Clone)]
pub(crate) struct Released {
    /// The world, for the counts.
    pub(crate) built: Built,
    /// The seeds at the end.
    pub(crate) frame: Frame,
    pub(crate) observables: Vec<ObservableValues>,
    /// Why they do not count as at rest; none where they rested before the limit.
    pub(crate) doubt: Option<Doubt>,
    /// Times by the clock of settling, of running out and of reading the pile, s.
    pub(crate) laps_s: [f64; 3],
}

/// Runs a release from its start, or from where it was left.
pub(crate) fn release(
    scene: &Scene,
    built: Built,
    left: Option<Progress>,
    keeper: &mut dyn Keeper,
) -> Result<Released, Error> {
    let mut watch = Stopwatch::start();
    let mut running = Running::new(scene, built, left)?;
    if !running.is_driven() {
        settle(&mut running, keeper)?;
        lift(&mut running)?;
    }
    let settling = watch.lap();
    let start = running.drive_since.unwrap_or(0.0);
    let rest = rest_energy(scene, &running.built.world);
    // The wall must be out of the way before rest can mean anything.
    let lifted = scene.apparatus.device().releases_after().unwrap_or(0.0);
    let limit = scene.protocol.rotation_limit.si();
    let mut rested = false;
    while !rested && running.built.world.time() - start < limit {
        running.offer(keeper)?;
        advance(scene, &mut running.built, SERIES_INTERVAL)?;
        let world = &running.built.world;
        rested = world.time() - start > lifted && world.kinetic_energy() < rest;
    }
    let measuring = watch.lap();
    let built = running.built;
    let doubt = if rested {
        None
    } else if is_driven_by_rolling(scene, &built) {
        Some(Doubt::DrivenByRolling)
    } else {
        Some(Doubt::NotAtRest)
    };
    let frame = snapshot(&built, built.world.time() - start);
    let observables = pile_observables(scene, &frame, &built.bodies);
    Ok(Released {
        built,
        frame,
        observables,
        doubt,
        laps_s: [settling, measuring, watch.lap()],
    })
}

/// Sets the wall in motion.
fn lift(running: &mut Running<'_>) -> Result<(), Error> {
    let built = &mut running.built;
    for mesh in &built.meshes {
        built.world.set_mesh_motion(&mesh.name, &mesh.motion)?;
    }
    let start = built.world.time();
    if let Some(surroundings) = &mut built.surroundings {
        surroundings.start(start);
    }
    running.drive_since = Some(start);
    Ok(())
}

/// Slope, height and extent.
fn pile_observables(
    scene: &Scene,
    frame: &Frame,
    bodies: &[Arc<SeedBody>],
) -> Vec<ObservableValues> {
    let spheres: Vec<Sphere> = frame.spheres(bodies).map(|(_, s)| s).collect();
    let largest = bodies.iter().map(|b| b.clump.bounding_radius());
    read_pile(&scene.apparatus, &spheres, largest.fold(0.0, f64::max))
}

/// Slope, height and extent of what lies in a heap or a box after the release: spheres at rest, from here or from another
/// code, in the frame of the apparatus. The columns of the outline are half as wide as the radius of the largest seed, m.
pub fn read_pile(
    apparatus: &Apparatus,
    spheres: &[Sphere],
    largest_radius: f64,
) -> Vec<ObservableValues> {
    let views: &[View] = match apparatus {
        Apparatus::Heap(_) => &[View::AlongZ, View::AlongX],
        _ => &[View::AlongZ],
    };
    let outlines: Vec<Outline> = views
        .iter()
        .filter_map(|view| Outline::of(spheres, *view, 0.5 * largest_radius))
        .collect();
    let is_heap = views.len() > 1;
    let mut angles: Vec<f64> = Vec::new();
    let mut ends = Vec::new();
    for outline in &outlines {
        angles.extend(outline.right_flank(FLANK));
        ends.push(outline.right_end());
        if is_heap {
            let mirrored = outline.mirrored();
            angles.extend(mirrored.right_flank(FLANK));
            ends.push(mirrored.right_end());
        }
    }
    let angles = angles.iter().map(|a| a.to_degrees()).collect();
    let heights = outlines.first().map(|o| 1e3 * o.height());
    let extent = ends.iter().map(|e| 1e3 * e).collect();
    let mut all = vec![
        ObservableValues::new("angle_of_repose_deg", "deg", angles),
        ObservableValues::new("height_mm", "mm", heights.into_iter().collect()),
        ObservableValues::new(
            if is_heap {
                "base_radius_mm"
            } else {
                "runout_mm"
            },
            "mm",
            extent,
        ),
    ];
    if let (false, Some(outline)) = (is_heap, outlines.first()) {
        let length = 1e3 * outline.right_foot(2.0 * largest_radius);
        all.push(ObservableValues::new("length_mm", "mm", vec![length]));
        for (name, part) in [("toe_angle_deg", TOE), ("top_angle_deg", TOP)] {
            let angle = outline.right_flank(part).map(f64::to_degrees);
            all.push(ObservableValues::new(
                name,
                "deg",
                angle.into_iter().collect(),
            ));
        }
    }
    all
}
