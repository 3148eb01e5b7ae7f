//! A box in the space of the parameters, and coordinates in it.

use crate::Parameter;

/// An end of a box within this share of the limits' width of a limit is the limit.
const SAME_END: f64 = 1e-12;

/// A box: one range for each parameter of the problem.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Region {
    /// Lower ends, units of the parameters.
    pub(crate) low: Vec<f64>,
    /// Upper ends.
    pub(crate) high: Vec<f64>,
}

impl Region {
    /// The box in which a search begins.
    pub(crate) fn first(parameters: &[Parameter]) -> Self {
        Self {
            low: parameters.iter().map(|p| p.range[0]).collect(),
            high: parameters.iter().map(|p| p.range[1]).collect(),
        }
    }

    /// A box of given half widths about a point, moved into the limits and cut where it is wider than they are.
    pub(crate) fn about(centre: &[f64], half: &[f64], parameters: &[Parameter]) -> Self {
        let (mut low, mut high) = (Vec::new(), Vec::new());
        for ((c, h), parameter) in centre.iter().zip(half).zip(parameters) {
            let [least, most] = parameter.limits;
            let width = 2.0 * h;
            let [from, to] = if width >= most - least {
                [least, most]
            } else {
                // Rounding can put an end a digit outside a limit, or a digit inside, as if there were a way left to go: the
                // limits have the last word.
                let rounding = SAME_END * (most - least);
                let near = |end: f64, limit: f64| (end - limit).abs() <= rounding;
                let from = (c - h).min(most - width).max(least);
                let to = (from + width).min(most);
                [
                    if near(from, least) { least } else { from },
                    if near(to, most) { most } else { to },
                ]
            };
            low.push(from);
            high.push(to);
        }
        Self { low, high }
    }

    /// Middle of the range of a parameter.
    pub(crate) fn centre(&self, j: usize) -> f64 {
        0.5 * (self.low[j] + self.high[j])
    }

    /// Half width of the range of a parameter.
    pub(crate) fn half(&self, j: usize) -> f64 {
        0.5 * (self.high[j] - self.low[j])
    }

    /// Half widths of all ranges.
    pub(crate) fn halves(&self) -> Vec<f64> {
        (0..self.low.len()).map(|j| self.half(j)).collect()
    }

    pub(crate) fn middle(&self) -> Vec<f64> {
        (0..self.low.len()).map(|j| self.centre(j)).collect()
    }

    /// A value of a parameter as a coordinate, -1 to 1 inside.
    pub(crate) fn coded(&self, j: usize, value: f64) -> f64 {
        (value - self.centre(j)) / self.half(j)
    }

    /// A coordinate as a value of a parameter; the ends of the range to the last digit.
    pub(crate) fn natural(&self, j: usize, coded: f64) -> f64 {
        if coded.abs() == 1.0 {
            return if coded > 0.0 {
                self.high[j]
            } else {
                self.low[j]
            };
        }
        self.centre(j) + coded * self.half(j)
    }
}

#[cfg(test)]
mod tests {
    use super::Region;
    use crate::Parameter;

    fn parameter(limits: [f64; 2]) -> Parameter {
        Parameter::new("a", limits)
    }

    /// A box that would leave the limits is moved, one that is wider is cut: it never leaves them.
    #[test]
    fn a_box_stays_inside_the_limits() {
        let parameters = [parameter([0.0, 1.0]), parameter([0.0, 1.0])];
        let region = Region::about(&[0.95, 0.5], &[0.2, 3.0], &parameters);
        assert!((region.low[0] - 0.6).abs() < 1e-15, "{region:?}");
        assert!((region.high[0] - 1.0).abs() < 1e-15, "{region:?}");
        assert_eq!((region.low[1], region.high[1]), (0.0, 1.0));
    }

    /// A box whose end is a limit but for rounding ends there: 0.151 - 0.15 is 0.0010000000000000009, and a search that took it for
    /// a face with room behind it would search the same box again.
    #[test]
    fn a_box_that_ends_at_a_limit_ends_there_to_the_last_digit() {
        let parameters = [parameter([0.001, 0.999]), parameter([0.001, 0.4])];
        let region = Region::about(&[0.151, 0.3], &[0.15, 0.1], &parameters);
        assert_eq!((region.low[0], region.high[1]), (0.001, 0.4), "{region:?}");
    }

    /// Limits whose width is rounded, such as 0.04 to 0.42: a box as wide as they are is they, to the last digit, its faces
    /// are its ends, and no box of any width leaves them.
    #[test]
    fn rounding_takes_no_box_out_of_the_limits() {
        for i in 1..200 {
            let limits = [f64::from(i) * 0.01, f64::from(i) * 0.01 + 0.38];
            let parameters = [parameter(limits)];
            for half in [0.01, 0.1, 0.19, 0.3] {
                for centre in [limits[0] - 0.1, limits[0], 0.5, limits[1] + 0.1] {
                    let region = Region::about(&[centre], &[half], &parameters);
                    assert!(
                        region.low[0] >= limits[0] && region.high[0] <= limits[1],
                        "{region:?}"
                    );
                    assert_eq!(region.natural(0, 1.0), region.high[0]);
                    assert_eq!(region.natural(0, -1.0), region.low[0]);
                }
            }
            let whole = Region::about(&[0.5], &[0.3], &parameters);
            assert_eq!((whole.low[0], whole.high[0]), (limits[0], limits[1]));
        }
    }
}
