//! Contacts that barely exist: the single-precision search must not miss what double precision
//! calls a contact, whatever the size of the bodies.

use crate::scene::{ball, seed_and_block, settings, smooth, world};
use dem_solver::{Placement, Settings, World, plain};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use probability::random_stream::Stream;

/// Two bodies at a distance (m) along a direction.
struct Pair {
    size: f64,
    orientations: [UnitQuaternion<f64>; 2],
    direction: Vector3<f64>,
}

impl Pair {
    fn random(size: f64, stream: &mut Stream) -> Self {
        let orientations = [(); 2].map(|()| {
            let [w, i, j, k] = stream.rotation();
            UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k))
        });
        let direction = Vector3::from_fn(|_, _| stream.normal()).normalize();
        Self {
            size,
            orientations,
            direction,
        }
    }

    fn at(&self, distance: f64) -> World {
        let position = self.direction * distance;
        let starts = [
            Placement::at_rest(0, Vector3::zeros(), self.orientations[0]),
            Placement::at_rest(1, position, self.orientations[1]),
        ];
        let settings = Settings {
            skin: 1e-7 * self.size,
            margin: 1e-3 * self.size,
            ..settings(1e-6, Vector3::zeros())
        };
        let templates = seed_and_block(self.size);
        world(settings, &smooth(), templates, Vec::new(), &starts)
    }

    /// Contacts of spheres by the plain loop.
    fn n_contacts(&self, distance: f64) -> usize {
        let mut history = plain::History::default();
        plain::loads(&self.at(distance), &mut history);
        history.n_contacts()
    }
}

/// The distance at which the first spheres touch is found to the last bit with the plain loop;
/// just inside of it, where the overlap is 1e-12 of the size, the fast loop must see the contact.
#[test]
fn faintest_contact_is_found_at_any_size() {
    let mut stream = Stream::new(10, "grazing");
    for size in [1e-2, 1.0, 1e2, 1e4] {
        for _ in 0..40 {
            let pair = Pair::random(size, &mut stream);
            let (mut touching, mut apart) = (0.0, 8e-3 * size);
            while apart - touching > 1e-14 * size {
                let middle = 0.5 * (touching + apart);
                if pair.n_contacts(middle) > 0 {
                    touching = middle;
                } else {
                    apart = middle;
                }
            }
            let expected = pair.n_contacts(touching);
            let mut world = pair.at(touching);
            world.step().expect("a faint contact is harmless");
            let found = world.census().sphere_contacts;
            assert_eq!(
                found,
                expected,
                "at size {size}, overlap below {} m",
                apart - touching
            );
        }
    }
}

/// Two balls in one place have no direction in which to part: they do not touch, and a third that touches both gets the
/// same from each. It stands one micrometre in, where the force of one is some 6e-5 N; what two equal forces and their
/// sum round by is 1e-16 of that.
#[test]
fn two_balls_in_one_place_leave_each_other_alone() {
    let radius = 1e-3;
    let third = Vector3::x() * (2.0 * radius - 1e-6);
    let pulled = |places: &[Vector3<f64>]| {
        let at_rest = |&place| Placement::at_rest(0, place, UnitQuaternion::identity());
        let starts: Vec<_> = places.iter().map(at_rest).collect();
        let settings = settings(1e-7, Vector3::zeros());
        let mut world = world(settings, &smooth(), vec![ball(radius)], Vec::new(), &starts);
        world.step().expect("nothing moves far in a step");
        let loads = world.bodies().load.iter();
        loads.map(|load| load.force().x).collect::<Vec<_>>()
    };
    let [one, other] = pulled(&[Vector3::zeros(), third])[..] else {
        panic!("two bodies")
    };
    assert!(one < 0.0 && one == -other, "{one} and {other} N");
    let three = pulled(&[Vector3::zeros(), Vector3::zeros(), third]);
    assert!(three[..2] == [one, one], "{three:?} N, alone {one} N");
    assert!((three[2] / other - 2.0).abs() < 1e-15, "{three:?} N");
}

/// A step reads 316 bytes of each body. Of two that touch it reads 8 of the pair, 24 of its list, 128 of each group of eight candidates
/// and 56 of each contact: these sizes are what docs/benchmarks.md rests on.
#[test]
fn a_step_reads_the_bodies_and_the_lists_of_those_that_are_near() {
    let pair = Pair::random(1.0, &mut Stream::new(11, "bytes"));
    let mut apart = pair.at(10.0);
    apart.step().unwrap();
    assert_eq!(apart.bytes_of_step(), 632);
    let mut touching = pair.at(3e-3);
    touching.step().unwrap();
    let census = touching.census();
    assert!(
        census.chunks > 0 && census.sphere_contacts > 0,
        "{census:?}"
    );
    let lists = 8 + 24 + 128 * census.chunks + 56 * census.sphere_contacts;
    assert_eq!(touching.bytes_of_step(), 632 + lists);
}
