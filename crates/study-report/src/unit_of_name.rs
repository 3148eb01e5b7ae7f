//! The unit of an observable, by the ending of its name.

/// Endings of the names of observables and the units that they stand for, longer ones first.
const ENDINGS: [(&str, &str); 7] = [
    ("_mm_s", "mm/s"),
    ("_deg", "°"),
    ("_mm", "mm"),
    ("_mj", "mJ"),
    ("_mw", "mW"),
    ("_n", "N"),
    ("_s", "s"),
];

/// The name without its unit, and the unit; none for a name without a unit, which is a plain number.
pub(crate) fn split_unit(name: &str) -> Option<(&str, &'static str)> {
    let split = |(ending, unit): &(&str, &'static str)| Some((name.strip_suffix(ending)?, *unit));
    ENDINGS.iter().find_map(split)
}

#[cfg(test)]
mod tests {
    use super::split_unit;

    #[test]
    fn a_length_is_not_a_plain_number_and_a_speed_is_not_a_length() {
        assert_eq!(split_unit("height_mm"), Some(("height", "mm")));
        assert_eq!(
            split_unit("surface_speed_mm_s"),
            Some(("surface_speed", "mm/s"))
        );
        assert_eq!(split_unit("toe_angle_deg"), Some(("toe_angle", "°")));
        assert_eq!(split_unit("curvature"), None);
    }
}
