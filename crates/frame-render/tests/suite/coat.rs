//! The coat of an object: of two triangles behind each other the nearer is seen, with its own light.

use frame_render::{ObjectView, render_object};

/// Seen along -z: a level square below a tilted one. Alone, the two have different colours in the middle;
/// together, in either order, the middle has that of the upper one, to the byte.
#[test]
fn the_nearer_triangle_is_seen_with_its_own_light() {
    let view = ObjectView {
        toward_camera: [0.0, 0.0, 1.0],
        pixels: 64,
    };
    let level = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]];
    let tilted = [[-1.0, -1.0, 0.5], [1.0, -1.0, 2.5], [0.0, 1.0, 1.5]];
    let middle = |triangles: &[[[f64; 3]; 3]]| {
        let picture = render_object(&[], triangles, &view).expect("a picture");
        picture.get_pixel(32, 32).0
    };
    let upper = middle(&[tilted]);
    assert_ne!(
        upper,
        middle(&[level]),
        "both levels agree: the test checks nothing"
    );
    assert_eq!(middle(&[level, tilted]), upper);
    assert_eq!(middle(&[tilted, level]), upper);
}
