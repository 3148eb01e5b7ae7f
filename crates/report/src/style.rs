//! Colours and sizes that all charts share.

use std::fmt::Write as _;

/// Blue, first choice. The series colours are the set of Okabe and Ito, chosen to stay apart for
/// colour-blind readers, in the order of their contrast with white paper.
pub const BLUE: &str = "#0072b2";
/// Vermilion, second choice.
pub const VERMILION: &str = "#d55e00";
/// Series colours in order of use.
pub(crate) const SERIES: [&str; 7] = [
    BLUE, VERMILION, "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#4d4d4d",
];
/// Text.
pub const INK: &str = "#222222";
/// Axis lines and tick marks.
pub const AXIS: &str = "#555555";
/// Grid lines.
pub(crate) const GRID: &str = "#e6e6e6";
/// Paper.
pub const PAPER: &str = "#ffffff";
/// Bands of noise and steady parts.
pub const BAND: &str = "#dfe7ee";

/// Width of every chart, px.
pub(crate) const WIDTH: f64 = 640.0;
/// Size of tick labels and notes, px.
pub(crate) const SMALL_TEXT: f64 = 12.0;
/// Size of axis titles and legends, px.
pub(crate) const TEXT: f64 = 13.0;
/// Radius of a marker, px.
pub(crate) const MARKER: f64 = 4.0;

/// Colour number `index` of a series; colours repeat after seven.
pub fn series(index: usize) -> &'static str {
    SERIES[index % SERIES.len()]
}

/// Stops of the sequential scale, sRGB, of falling lightness so that it survives a grey print.
const SEQUENTIAL: [[f64; 3]; 6] = [
    [247.0, 245.0, 226.0],
    [208.0, 226.0, 199.0],
    [150.0, 199.0, 193.0],
    [92.0, 162.0, 189.0],
    [57.0, 117.0, 169.0],
    [42.0, 70.0, 128.0],
];

/// Colour at a share in [0, 1] of the sequential scale, light to dark.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to the scale just before"
)]
pub fn sequential(share: f64) -> String {
    let last = SEQUENTIAL.len() - 1;
    let place = share.clamp(0.0, 1.0) * last as f64;
    let below = (place.floor() as usize).min(last - 1);
    let part = place - below as f64;
    let mut text = String::from("#");
    for (light, dark) in SEQUENTIAL[below].into_iter().zip(SEQUENTIAL[below + 1]) {
        let channel = (light + (dark - light) * part).round().clamp(0.0, 255.0) as u8;
        write!(text, "{channel:02x}").expect("a String takes any text");
    }
    text
}
