//! YADE: `x y z r clump` a line, in metres.

use super::Body;
use super::rows::{in_unit, joined};

/// `ymport.textClumps` takes the last column as the number of the clump; `ymport.text` reads the
/// first four and ignores it.
pub(crate) fn text(body: &Body<'_>) -> String {
    let mut text = "# x y z radius clump, m\n".to_owned();
    for sphere in body.spheres {
        text.extend([joined(&in_unit(sphere, 1.0), " "), " 0\n".to_owned()]);
    }
    text
}
