//! The unit of an observable, by the ending of its name.

/// Endings of the names of observables and the units that they stand for, longer ones first.
const ENDINGS: [(&str, &str); 14] = [
    ("_kg_m3", "kg/m³"),
    ("_mm_s", "mm/s"),
    ("_n_mm", "N mm"),
    ("_m_s", "m/s"),
    ("_g_s", "g/s"),
    ("_kpa", "kPa"),
    ("_deg", "°"),
    ("_mm", "mm"),
    ("_mj", "mJ"),
    ("_mw", "mW"),
    ("_g", "g"),
    ("_n", "N"),
    ("_s", "s"),
    ("_percent", "%"),
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
        for (name, stem, unit) in [
            ("mass_flow_g_s", "mass_flow", "g/s"),
            ("surface_speed_m_s", "surface_speed", "m/s"),
            ("bulk_density_kg_m3", "bulk_density", "kg/m³"),
            ("peak_shear_stress_kpa", "peak_shear_stress", "kPa"),
            ("paddle_torque_n_mm", "paddle_torque", "N mm"),
            ("discharge_slope_percent", "discharge_slope", "%"),
            ("left_behind_g", "left_behind", "g"),
        ] {
            assert_eq!(split_unit(name), Some((stem, unit)), "{name}");
        }
    }
}
