//! What the settings of the data span.

use experiment_design::Factor;
use serde::{Deserialize, Serialize};

use crate::Fit;

/// Share of a half-width by which a point may lie beyond and count as inside: the rounding of coded values.
const SLACK: f64 = 1e-9;

/// Coordinate of another value of a factor that never varies, half-widths: a finite one can be drawn.
const FAR: f64 = 1e6;

/// The part of the space of the factors that the runs span, whatever the ranges of the factors are: the box of their settings,
/// without its corners if no run lies as far from its middle as they do.
///
/// # Formula
/// `z_j = (u_j - (low_j + high_j) / 2) / ((high_j - low_j) / 2)`; inside: all `|z_j| <= 1` and `|z| <=` the greatest `|z|` of the
/// runs. Of a factorial and a face-centred composite this is the box, of a rotatable composite the sphere through its axial
/// runs, of a Box-Behnken design the sphere through the middles of its edges.
///
/// # Source
/// Cuboidal and spherical regions of interest of designs: `[Myers2016, chapter 8]`. The convex hull of the runs would exclude
/// most of the box of a Latin hypercube.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DataRegion {
    /// Least value of each factor in the data, units of the factors.
    pub low: Vec<f64>,
    /// Greatest value of each factor in the data, units of the factors.
    pub high: Vec<f64>,
    /// Greatest distance of a run from the middle of that box, half-widths of the box.
    pub radius: f64,
}

impl DataRegion {
    /// The region of settings in the units of the factors; none without settings.
    pub(crate) fn of(settings: &[Vec<f64>]) -> Option<Self> {
        let first = settings.first()?;
        let end = |pick: fn(f64, f64) -> f64| -> Vec<f64> {
            let all = |j: usize| settings.iter().map(|u| u[j]).fold(first[j], pick);
            (0..first.len()).map(all).collect()
        };
        let mut region = Self {
            low: end(f64::min),
            high: end(f64::max),
            radius: 0.0,
        };
        region.radius = settings
            .iter()
            .map(|u| region.distance(u))
            .fold(0.0, f64::max);
        Some(region)
    }

    /// Whether a point in the units of the factors lies inside.
    pub fn holds(&self, natural: &[f64]) -> bool {
        self.beyond(natural) <= 0.0
    }

    /// How far a point lies outside, squared half-widths of the box; 0 or less inside.
    pub fn beyond(&self, natural: &[f64]) -> f64 {
        let all = (0..self.low.len()).map(|j| self.scaled(natural, j).abs());
        let past = |size: f64, limit: f64| size.powi(2) - (limit * (1.0 + SLACK)).powi(2);
        past(self.distance(natural), self.radius).max(past(all.fold(0.0, f64::max), 1.0))
    }

    /// Distance of a point from the middle of the box of the data, half-widths of the box.
    pub fn distance(&self, natural: &[f64]) -> f64 {
        let squares = (0..self.low.len()).map(|j| self.scaled(natural, j).powi(2));
        squares.sum::<f64>().sqrt()
    }

    /// A coordinate from the middle of the box in half-widths; of a factor that never varies 0 at its value.
    fn scaled(&self, natural: &[f64], j: usize) -> f64 {
        let (low, high, u) = (self.low[j], self.high[j], natural[j]);
        // Halved before they are added: the sum of two large ends may overflow.
        let (middle, half) = (low / 2.0 + high / 2.0, high / 2.0 - low / 2.0);
        if half <= SLACK * middle.abs() {
            // Of a factor that never varies another value is far away.
            let is_it = (u - middle).abs() <= SLACK * middle.abs().max(u.abs());
            return if is_it { 0.0 } else { FAR };
        }
        (u - middle) / half
    }

    /// The region without the factors at some places.
    pub(crate) fn without(&self, dropped: &[usize]) -> Self {
        let left = |values: &[f64]| -> Vec<f64> {
            let kept = values.iter().enumerate();
            let kept = kept.filter(|(j, _)| !dropped.contains(j));
            kept.map(|(_, value)| *value).collect()
        };
        Self {
            low: left(&self.low),
            high: left(&self.high),
            radius: self.radius,
        }
    }
}

/// A bound of a factor beyond which there are data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OpenBound {
    /// Symbol of the factor.
    pub symbol: String,
    /// The bound, unit of the factor.
    pub bound: f64,
    /// How far the data extend on that side, unit of the factor.
    pub data: f64,
}

impl Fit {
    /// Whether a point in the units of the factors lies outside what the data span; outside the ranges of the factors if the
    /// data are not known.
    pub fn is_beyond_data(&self, natural: &[f64]) -> bool {
        match &self.data_region {
            Some(region) => !region.holds(natural),
            None => self.coded(natural).iter().any(|x| x.abs() > 1.0 + SLACK),
        }
    }

    /// The bounds that a coded point lies on although the data extend beyond them.
    pub fn open_bounds(&self, coded: &[f64]) -> Vec<OpenBound> {
        let Some(region) = &self.data_region else {
            return Vec::new();
        };
        let found = |(j, factor): (usize, &Factor)| {
            let (bound, data) = if coded[j] >= 1.0 - NEAR_BOUND {
                (factor.high(), region.high[j])
            } else if coded[j] <= -1.0 + NEAR_BOUND {
                (factor.low(), region.low[j])
            } else {
                return None;
            };
            let beyond = factor.coded(data) * coded[j].signum() - 1.0;
            (beyond > NEAR_BOUND).then(|| OpenBound {
                symbol: factor.symbol().to_owned(),
                bound,
                data,
            })
        };
        self.factors.iter().enumerate().filter_map(found).collect()
    }
}

/// Distance in half-ranges at which a point counts as on a bound: the last step of the search for settings is 1e-7.
const NEAR_BOUND: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::DataRegion;
    use experiment_design::{
        AxialDistance, Factor, box_behnken, central_composite, full_factorial,
    };

    fn factors(k: usize) -> Vec<Factor> {
        let factor = |j: usize| Factor::new(&format!("x{j}"), "", "1", 10.0, 20.0).unwrap();
        (0..k).map(factor).collect()
    }

    fn region(design: &experiment_design::Design) -> DataRegion {
        let runs = 0..design.runs().len();
        DataRegion::of(&runs.map(|i| design.natural(i)).collect::<Vec<_>>()).unwrap()
    }

    /// Coded point to natural one of the factors above.
    fn at(coded: &[f64]) -> Vec<f64> {
        coded.iter().map(|x| 15.0 + 5.0 * x).collect()
    }

    /// The axial runs of a rotatable composite of two factors lie at sqrt(2): a point at radius 1.3 is inside, be it beyond the
    /// ranges or not, one at radius 1.5 is not, though the box of the data holds it.
    #[test]
    fn a_rotatable_composite_spans_the_disc_through_its_axial_runs() {
        let design = central_composite(&factors(2), AxialDistance::Rotatable, 5).unwrap();
        let region = region(&design);
        for (point, inside) in [
            ([1.3, 0.0], true),
            ([0.9, -0.9], true),
            ([1.0, 1.0], true),
            ([1.1, 1.1], false),
            ([1.42, 0.0], false),
        ] {
            assert_eq!(region.holds(&at(&point)), inside, "{point:?}");
        }
    }

    /// A factorial at 0.8 of the ranges: (1, 0) lies beyond its box although nearer to the middle than the corners. A factor that never
    /// varies holds its value, to rounding, and no other; all distances are finite.
    #[test]
    fn a_point_beyond_one_face_is_outside_and_a_constant_factor_holds_its_value() {
        let runs = [[-0.8, -0.8], [0.8, -0.8], [-0.8, 0.8], [0.8, 0.8]].map(|x| at(&x));
        let region = DataRegion::of(&runs).unwrap();
        assert!(region.holds(&at(&[0.8, 0.0])) && !region.holds(&at(&[1.0, 0.0])));
        assert!(region.beyond(&at(&[1.0, 0.0])) > 0.5);
        let constant = DataRegion::of(&[vec![1.0, 0.3], vec![2.0, 0.3]]).unwrap();
        assert!(constant.holds(&[1.5, 0.1 + 0.2]));
        let other = constant.beyond(&[1.5, 0.4]);
        assert!(other > 0.0 && other.is_finite(), "{other}");
    }

    /// The cube of a factorial reaches its corners, that of a Box-Behnken design does not: its runs lie at sqrt(2) of sqrt(3).
    #[test]
    fn the_corners_of_the_cube_belong_to_a_factorial_and_not_to_a_box_behnken_design() {
        let full = region(&full_factorial(&factors(3), 0).unwrap());
        let middles = region(&box_behnken(&factors(3), 3).unwrap());
        assert!(full.holds(&at(&[1.0, -1.0, 1.0])) && !full.holds(&at(&[1.1, 0.0, 0.0])));
        assert!(!middles.holds(&at(&[1.0, -1.0, 1.0])) && middles.holds(&at(&[1.0, 1.0, 0.0])));
        assert!(middles.holds(&at(&[1.0, 0.9, 0.3])));
    }
}
