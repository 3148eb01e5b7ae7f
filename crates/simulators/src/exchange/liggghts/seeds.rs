//! The seeds of a deck for LIGGGHTS: their shapes, and how they get into the drum.

use super::RATE;
use crate::exchange::drum_deck::{are_spheres, density_of_sphere, first_of};
use crate::exchange::vtk::add;
use input::quantity::Frequency;
use nalgebra::Vector3;
use scene::{Frame, Scene, SeedBody};
use std::sync::Arc;

/// Half the edge of the box in which the centre of a seed is put, m: far below the overlaps of contacts.
const PLACE: f64 = 1e-8;

/// Name of the file with the spheres of a kind of seeds.
pub(super) fn spheres_file(kind: usize) -> String {
    format!("seed{}.spheres", kind + 1)
}

/// Spheres at the surface, about the centre of mass, in principal axes.
pub(super) fn spheres(body: &SeedBody) -> String {
    let mut text = String::new();
    for sphere in body.outer.spheres() {
        let c = sphere.centre;
        let row = format_args!("{:e} {:e} {:e} {:e}\n", c.x, c.y, c.z, sphere.radius);
        add(&mut text, row);
    }
    text
}

/// The shape of a kind of seeds, and a distribution of it alone: one of all kinds does not keep their
/// numbers. Mass and inertia are given, but the centre of mass is found from so many random points.
fn shape(
    kind: usize,
    body: &SeedBody,
    points: u32,
    primes: &mut impl Iterator<Item = u64>,
) -> String {
    let (number, file) = (kind + 1, spheres_file(kind));
    if body.clump.spheres().len() == 1 {
        let [first, second] = [(); 2].map(|()| primes.next().unwrap_or(0));
        return format!(
            "fix seed{number} all particletemplate/sphere {first} atom_type 1 density constant {} radius constant {:e}\n\
             fix kind{number} all particledistribution/discrete {second} 1 seed{number} 1.0\n",
            density_of_sphere(body),
            body.clump.spheres()[0].radius,
        );
    }
    let (n, i) = (body.outer.spheres().len(), body.clump.inertia());
    let [first, second] = [(); 2].map(|()| primes.next().unwrap_or(0));
    format!(
        "fix seed{number} all particletemplate/multisphere {first} atom_type 1 density constant {} \
         nspheres {n} ntry {points} spheres file {file} scale 1.0 type {number} mass {:e} \
         inertia_tensor {:e} 0.0 0.0 {:e} 0.0 {:e} use_volume\n\
         fix kind{number} all particledistribution/discrete {second} 1 seed{number} 1.0\n",
        body.fraction_density,
        body.clump.mass(),
        i.x,
        i.y,
        i.z,
    )
}

/// The seeds of each kind and how they rain into the region `sky`, after so many steps each time and with these words for attempts.
pub(super) fn rain(
    scene: &Scene,
    bodies: &[Arc<SeedBody>],
    (every, attempts): (f64, &str),
    seed: u64,
) -> String {
    let mut primes = primes_from(first_of(seed));
    let rate = scene.protocol.insertion_rate.map_or(RATE, Frequency::si);
    let turned = if are_spheres(bodies) {
        ""
    } else {
        "orientation random "
    };
    let mut text = String::new();
    for (k, (kind, body)) in scene.seed.iter().zip(bodies).enumerate() {
        text.push_str(&shape(k, body, 100_000, &mut primes));
        let number = k + 1;
        let rate = rate * scene.count_of(kind) as f64 / scene.seed_count() as f64;
        add(
            &mut text,
            format_args!(
                "fix rain{number} all insert/rate/region seed {} distributiontemplate kind{number}{attempts} \
                 nparticles {} particlerate {rate} insert_every {every} overlapcheck yes all_in yes \
                 {turned}region sky ntry_mc 10000\n",
                primes.next().unwrap_or(0),
                scene.count_of(kind),
            ),
        );
    }
    text
}

/// The seeds of a frame, one insertion each.
pub(super) fn placed(bodies: &[Arc<SeedBody>], frame: &Frame) -> String {
    let mut primes = primes_from(10_007);
    let mut text = String::new();
    for (k, body) in bodies.iter().enumerate() {
        // The points scatter by about a millimetre, so the centre is right to about a micrometre.
        text.push_str(&shape(k, body, 10_000_000, &mut primes));
    }
    let centroids: Vec<_> = bodies.iter().map(|body| centroid(body)).collect();
    for i in 0..frame.position.len() {
        let (kind, turn) = (frame.kind[i], frame.orientation[i]);
        // What is put into the place is the centre of the spheres' volume.
        let c = frame.position[i] + turn * centroids[kind];
        let (v, w, q) = (frame.velocity[i], frame.spin[i], turn.coords);
        let edges = [c.x, c.y, c.z].map(|x| format!("{:.10} {:.10}", x - PLACE, x + PLACE));
        add(
            &mut text,
            format_args!(
                "region place{i} block {} units box volume_limit 1e-30\n\
                 fix put{i} all insert/pack seed {} distributiontemplate kind{} insert_every once \
                 overlapcheck no all_in no vel constant {:e} {:e} {:e} omega constant {:e} {:e} {:e} \
                 orientation constant {} {} {} {} particles_in_region 1 region place{i} ntry_mc 1000\n",
                edges.join(" "),
                primes.next().unwrap_or(0),
                kind + 1,
                v.x,
                v.y,
                v.z,
                w.x,
                w.y,
                w.z,
                q.w,
                q.x,
                q.y,
                q.z,
            ),
        );
    }
    text
}

/// Centre of the volume of the spheres at the surface, as if they did not overlap, m.
fn centroid(body: &SeedBody) -> Vector3<f64> {
    let (mut moment, mut volume) = (Vector3::zeros(), 0.0);
    for sphere in body.outer.spheres() {
        let own = sphere.radius.powi(3);
        moment += sphere.centre * own;
        volume += own;
    }
    moment / volume
}

/// The step in which the seeds of a frame are put in, and the end of the insertions.
pub(super) fn put(frame: &Frame) -> String {
    let mut text = "run 1\n".to_owned();
    for i in 0..frame.position.len() {
        add(
            &mut text,
            format_args!("unfix put{i}\nregion place{i} delete\n"),
        );
    }
    text
}

/// Prime numbers from a number on, as LIGGGHTS wants them for its random numbers.
pub(super) fn primes_from(first: u64) -> impl Iterator<Item = u64> {
    let is_prime = |n: &u64| !(2..=n.isqrt()).any(|d| n.is_multiple_of(d));
    (first..).filter(is_prime)
}
