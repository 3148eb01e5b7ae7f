//! Where the seeds lay in the last frame, as a record keeps it.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use scene::{Frame, SeedBody};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The seeds of a frame as 32-bit little-endian floats in base 64: enough to look at, some 45 bytes a seed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyDetails {
    /// Of each kind of seed the spheres that can be seen, in its own frame: x, y, z and radius, m.
    pub kinds_base64: Vec<String>,
    /// Of each seed its kind (from 0), its centre of mass x, y, z (m), and its rotation as a quaternion w, x, y, z.
    pub seeds_base64: String,
}

impl BodyDetails {
    pub(crate) fn of(frame: &Frame, bodies: &[Arc<SeedBody>]) -> Self {
        let spheres = |body: &Arc<SeedBody>| {
            let spheres = body.outer.spheres().iter();
            encoded(spheres.flat_map(|s| [s.centre.x, s.centre.y, s.centre.z, s.radius]))
        };
        let places = frame
            .kind
            .iter()
            .zip(&frame.position)
            .zip(&frame.orientation);
        let places =
            places.flat_map(|((&kind, p), q)| [kind as f64, p.x, p.y, p.z, q.w, q.i, q.j, q.k]);
        Self {
            kinds_base64: bodies.iter().map(spheres).collect(),
            seeds_base64: encoded(places),
        }
    }
}

/// Numbers as floats of 32 bits in base 64.
#[expect(
    clippy::cast_possible_truncation,
    reason = "32 bits suffice for a screen"
)]
fn encoded(numbers: impl Iterator<Item = f64>) -> String {
    let bytes: Vec<u8> = numbers.flat_map(|x| (x as f32).to_le_bytes()).collect();
    STANDARD.encode(bytes)
}
