//! What is physically possible where the study file states no limits.

/// Largest coefficient of friction that the search tries by itself.
///
/// A friction of 2 is a slope of 63 degrees between two surfaces; those of seeds and plates are below 1.
/// Our choice: doubling it lets a search out of reach continue for one box more.
const MOST_FRICTION: f64 = 2.0;

/// Smallest and largest restitution: at 0 nothing moves apart, at 1 nothing is lost, and both are limits that no
/// material reaches. Our choice.
const RESTITUTION: [f64; 2] = [0.001, 0.999];

/// Largest size of a number in a study file. Squares and products of such numbers are still finite, and no quantity of
/// seeds comes near it in any unit. Our choice.
pub(crate) const MOST: f64 = 1e15;

/// Smallest size of a number in a study file that is not 0. No quantity of seeds comes near it in SI units, the moment of inertia of a grain of
/// 10 um being some 1e-22 kg m2; squares and reciprocals of squares are still exact. Our choice.
pub(crate) const LEAST: f64 = 1e-30;

/// Smallest ratio of a standard deviation to its mean, and of a range to its ends: nothing is measured to nine
/// digits, and the rounding of numbers is far below. Our choice.
pub(crate) const LEAST_RATIO: f64 = 1e-9;

/// Longest name, bytes: that of a study and that of its profile make one name of a folder, of which file systems take 255.
pub(crate) const LONGEST_NAME: usize = 100;

/// Longest text, bytes. Our choice: some pages.
pub(crate) const LONGEST_TEXT: usize = 10_000;

/// Shortest limit of the time of a run of a program of the user, s: no program starts in less.
pub(crate) const LEAST_TIME_S: f64 = 1e-3;

/// Most runs that one key of `[design]` can ask for: our choice, a hundred times the usual.
pub(crate) const MOST_RUNS: usize = 1000;

/// Longest time of a run of a program of the user, s: a year.
pub(crate) const MOST_TIME_S: f64 = 3.2e7;

/// Between which values the mean of an observable can lie, by its name, with its unit and the slip that leads outside.
pub(crate) fn range_of(observable: &str) -> ([f64; 2], &'static str) {
    match observable {
        // The slope of a surface, always that of the side that stands higher. Upright is 1.57 in radians, and no seeds
        // lie as level as that in degrees.
        "angle_deg" | "angle_of_repose_deg" => ([1.6, 90.0], " deg, in degrees and not in radians"),
        "fill_level" | "shown_restitution" => ([0.0, 1.0], ""),
        _ if observable.ends_with("_deg") => ([-360.0, 360.0], " deg"),
        // Seeds that interlock show up to the tangent of 80 degrees, where a tilt ends.
        "shown_static_friction" | "shown_rolling_friction" => {
            ([0.0, 6.0], ", a ratio of forces or a tangent and no angle")
        }
        _ => ([-MOST, MOST], ""),
    }
}

/// The limits of a setting by the last word of its path; `None` if nothing is known of it.
pub(crate) fn physical_limits(path: &str) -> Option<[f64; 2]> {
    match path.rsplit('.').next() {
        Some("static_friction" | "rolling_friction") => Some([0.0, MOST_FRICTION]),
        Some("restitution") => Some(RESTITUTION),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::{physical_limits, range_of};

    /// An inclination is between level and upright; of a name that says nothing nothing is known.
    #[test]
    fn angles_have_a_range_by_their_name() {
        assert_eq!(range_of("angle_deg").0, [1.6, 90.0]);
        assert_eq!(range_of("toe_position_deg"), ([-360.0, 360.0], " deg"));
        assert_eq!(range_of("flow_g_s").0, [-1e15, 1e15]);
    }

    #[test]
    fn only_what_is_known_has_limits_of_its_own() {
        let of = |word: &str| physical_limits(&format!("contact.pea-pea.{word}"));
        assert_eq!(of("static_friction"), Some([0.0, 2.0]));
        assert_eq!(of("restitution"), Some([0.001, 0.999]));
        assert_eq!(of("attraction_n"), None);
    }
}
