//! The regression of the published cotton study, for comparison only.

use crate::StudyFile;

/// A factor of eq. (10) with its levels of Table 2.
#[derive(Debug)]
struct PublishedFactor {
    /// Symbol.
    symbol: &'static str,
    /// Low level, 1.
    low: f64,
    /// High level, 1.
    high: f64,
}

/// Factors of the published surface with the levels of Table 2 of the study.
const FACTORS: [PublishedFactor; 3] = [
    PublishedFactor {
        symbol: "B",
        low: 0.30,
        high: 0.42,
    },
    PublishedFactor {
        symbol: "E",
        low: 0.01,
        high: 0.18,
    },
    PublishedFactor {
        symbol: "F",
        low: 0.0,
        high: 0.10,
    },
];

/// Eq. (10) of the study as printed, deg over coded factors:
/// 36.39 + 1.25 B - 0.56 E + 3.52 F + 0.34 BE + 0.44 BF - 0.11 EF - 0.52 B² + 0.24 E² - 0.25 F².
fn equation_10(b: f64, e: f64, f: f64) -> f64 {
    let linear = 36.39 + 1.25 * b - 0.56 * e + 3.52 * f;
    let products = 0.34 * b * e + 0.44 * b * f - 0.11 * e * f;
    linear + products - 0.52 * b * b + 0.24 * e * e - 0.25 * f * f
}

/// Effects of Table 4 of the study: symbol, and mean at high minus mean at low level, deg.
const EFFECTS: [(&str, f64); 6] = [
    ("A", -0.16),
    ("B", 2.58),
    ("C", -0.053),
    ("D", 0.45),
    ("E", -0.8),
    ("F", 6.55),
];

/// The published regression, where it speaks of the factors of a study.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PublishedSurface {
    /// Factors with their levels.
    factors: &'static [PublishedFactor; 3],
    /// Effects of the screening: symbol and effect, deg.
    effects: &'static [(&'static str, f64); 6],
}

/// What the study printed.
const PRINTED: PublishedSurface = PublishedSurface {
    factors: &FACTORS,
    effects: &EFFECTS,
};

impl PublishedSurface {
    /// The published regression for a study with the same factors on the same levels; none for
    /// any other study.
    pub(crate) fn of(study: &StudyFile) -> Option<Self> {
        let same = |p: &PublishedFactor| {
            let found = study.factor.iter().find(|f| f.symbol == p.symbol);
            found.is_some_and(|f| f.low == p.low && f.high == p.high)
        };
        FACTORS.iter().all(same).then_some(PRINTED)
    }

    /// Angle at natural values by symbol, deg; none where a factor is missing or lies outside of
    /// the levels, where the regression was not made.
    pub(crate) fn angle_deg(self, value: &dyn Fn(&str) -> Option<f64>) -> Option<f64> {
        let mut coded = [0.0; 3];
        for (x, p) in coded.iter_mut().zip(self.factors) {
            let (mid, half) = (0.5 * (p.low + p.high), 0.5 * (p.high - p.low));
            *x = (value(p.symbol)? - mid) / half;
            if x.abs() > 1.0 + 1e-9 {
                return None;
            }
        }
        Some(equation_10(coded[0], coded[1], coded[2]))
    }

    /// Published effect of a factor in the screening, deg.
    pub(crate) fn effect_deg(self, symbol: &str) -> Option<f64> {
        self.effects
            .iter()
            .find(|(name, _)| *name == symbol)
            .map(|(_, effect)| *effect)
    }
}

#[cfg(test)]
mod tests {
    use super::PRINTED;

    /// Angle at B, E, F.
    fn angle(b: f64, e: f64, f: f64) -> Option<f64> {
        PRINTED.angle_deg(&|symbol| match symbol {
            "B" => Some(b),
            "E" => Some(e),
            "F" => Some(f),
            _ => None,
        })
    }

    #[test]
    fn the_printed_equation_gives_39_07_at_the_printed_optimum() {
        // By hand: B = -0.5, E = -7/17, F = 1. The tolerance is the rounding of the two decimals.
        let found = angle(0.33, 0.06, 0.10).expect("inside the levels");
        assert!((found - 39.07).abs() < 0.005, "{found}");
    }

    #[test]
    fn the_middle_gives_the_constant_and_points_outside_give_nothing() {
        let middle = angle(0.36, 0.095, 0.05).expect("inside");
        assert!((middle - 36.39).abs() < 1e-12, "only rounding: {middle}");
        assert_eq!(
            angle(0.33, 0.06, 0.56),
            None,
            "the bench friction is far outside"
        );
    }

    #[test]
    fn edges_of_the_design_agree_with_table_5_within_its_residuals() {
        // Cells 11 and 9 of Table 5; the regression's root mean square error is 0.37 deg.
        for (point, cell) in [((0.36, 0.01, 0.10), 40.70), ((0.36, 0.01, 0.0), 33.21)] {
            let found = angle(point.0, point.1, point.2).expect("inside");
            assert!((found - cell).abs() < 0.8, "{found} against {cell}");
        }
    }
}
