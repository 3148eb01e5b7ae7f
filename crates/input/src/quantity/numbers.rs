//! Lists of bare numbers in one text, such as places in a picture.

/// N finite numbers separated by commas; `None` for any other text.
///
/// ```
/// assert_eq!(input::quantity::numbers("3, -0.5"), Some([3.0, -0.5]));
/// assert_eq!(input::quantity::numbers::<2>("3"), None);
/// assert_eq!(input::quantity::numbers::<1>("inf"), None);
/// ```
pub fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let values: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    let values: [f64; N] = values.ok()?.try_into().ok()?;
    values.iter().all(|v| v.is_finite()).then_some(values)
}

/// Points `X,Y` separated by semicolons; `None` for any other text.
///
/// ```
/// assert_eq!(input::quantity::places("3,4; 5,6"), Some(vec![[3.0, 4.0], [5.0, 6.0]]));
/// assert_eq!(input::quantity::places("3,4;"), None);
/// ```
pub fn places(text: &str) -> Option<Vec<[f64; 2]>> {
    text.split(';').map(numbers).collect()
}
