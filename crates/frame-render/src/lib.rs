//! Pictures of spheres as a camera would see them.
//!
//! There are three cameras. [`render_drum`] looks along the axis of a rotating drum through its
//! end cover, so that the picture can be measured like a photograph; [`render_side`] looks at
//! bodies on a floor; [`render_object`] looks at one particle from a free direction. All fill a depth buffer with ray-intersected spheres.
//!
//! Invariants:
//! - The same input gives the same bytes on every machine with IEEE arithmetic: one thread, a
//!   fixed order, the first sphere of the list wins if two are equally near.
//! - A scene mirrored in x (with the opposite roll) gives exactly the mirrored picture.
//! - Pixel coordinates are continuous with the *centre* of the upper left pixel at (0, 0),
//!   columns to the right and rows downward; see [`DrumProjection`].
//!
//! ```
//! use frame_render::{DrumView, RenderSphere, render_drum, seed_colour};
//!
//! let view = DrumView::new(0.05, 0.02, 200);
//! let seed = RenderSphere { centre: [0.0, -0.04, 0.0], radius: 0.004, colour: seed_colour(0) };
//! let picture = render_drum(&[seed], &view)?;
//! let below = view.projection()?.pixel_from_metre([0.0, -0.04]);
//! assert_eq!(below.column, 99.5);
//! assert!(picture.get_pixel(99, 173).0[1] < 130, "the seed is dark");
//! assert!(picture.get_pixel(99, 99).0[1] > 200, "the back cover is light");
//! # Ok::<(), frame_render::Error>(())
//! ```

mod coat;
mod colour;
mod depth_buffer;
mod drum;
mod drum_view;
mod error;
mod object;
mod segments;
mod sphere;

pub use colour::{BACKGROUND_COLOUR, OUTSIDE_COLOUR, RIM_COLOUR, seed_colour};
pub use drum::{SideView, render_drum, render_drum_with_walls, render_side};
pub use drum_view::{Camera, DrumProjection, DrumView, PixelPoint};
pub use error::Error;
pub use object::{ObjectView, render_object};
pub use segments::draw_segments;
pub use sphere::RenderSphere;
