//! What is physically possible where the study file states no limits.

/// Largest coefficient of friction that the search tries by itself.
///
/// A friction of 2 stands for a slope of 63 degrees between two surfaces; those of seeds and plates lie below 1.
/// Our choice: doubling it lets a search out of reach go on for one box more.
const MOST_FRICTION: f64 = 2.0;

/// Smallest and largest restitution: at 0 nothing moves apart, at 1 nothing is lost, and both are limits that no
/// material reaches. Our choice.
const RESTITUTION: [f64; 2] = [0.001, 0.999];

/// The limits of a setting by the last word of its path; none where nothing is known of it.
pub(crate) fn physical_limits(path: &str) -> Option<[f64; 2]> {
    match path.rsplit('.').next() {
        Some("static_friction" | "rolling_friction") => Some([0.0, MOST_FRICTION]),
        Some("restitution") => Some(RESTITUTION),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::physical_limits;

    #[test]
    fn only_what_is_known_has_limits_of_its_own() {
        let of = |word: &str| physical_limits(&format!("contact.pea-pea.{word}"));
        assert_eq!(of("static_friction"), Some([0.0, 2.0]));
        assert_eq!(of("restitution"), Some([0.001, 0.999]));
        assert_eq!(of("attraction_n"), None);
    }
}
