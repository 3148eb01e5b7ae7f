//! Drawn pictures of drums and heaps whose surface is known exactly.
//!
//! They are the yardstick of whatever reads photos, and share no code with it: straight, curved and S-shaped surfaces, fine
//! powder or coarse grains, either polarity, blur, noise, rim and dust. Every scene draws the same picture each time.
//!
//! ```
//! use dev_support::drawn_pictures::Scene;
//! let scene = Scene { inclination: 0.6, ..Scene::default() };
//! let picture = scene.draw();
//! assert_eq!(picture.width(), scene.size);
//! let (first, last) = (scene.surface()[0], *scene.surface().last().unwrap());
//! let rise = (last.y - first.y).atan2(last.x - first.x);
//! assert!((rise.abs() - 0.6).abs() < 0.01);
//! ```

mod camera;
mod disturbance;
mod drum;
mod file;
mod heap;
mod kinds;
mod paint;

pub use disturbance::Disturbance;
pub use drum::Scene;
pub use file::save;
pub use heap::HeapScene;
pub use kinds::{Class, Kind, Trial, kinds};
