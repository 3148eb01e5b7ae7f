//! What the frames of a series that show no value could change in its mean.

use probability::{normal_density, normal_upper_quantile};
use surface_profile::SeriesSummary;

/// Largest share of frames without a value: up to here the bound of [`SelectionBias`] is strict.
const LARGEST_SHARE: f64 = 0.25;

/// How far the mean over the frames that were read may lie from that over all frames.
///
/// What keeps a frame from being read may go with its value: the roughest or steepest moments of a bed are refused first. The
/// bound is that of the worst case, in which the frames without a value are the highest of all, or the lowest.
///
/// # Formula
///
/// The values of all frames are normal. Cut off is the upper share q, at z with `1 - cdf(z) = q`. The others have a mean that is
/// `l = density(z) / (1 - q)` standard deviations of all lower, and the variance `1 - z l - l^2` of that of all. The bias in standard
/// deviations of the values that were read is `l / sqrt(1 - z l - l^2)`; no other choice of a share up to a quarter gives more
/// (the worst choice keeps an interval, and among the intervals of one probability this is the worst).
///
/// # Source
///
/// Worst cases of selection: `[HorowitzManski1995]`; moments of a truncated normal distribution: `[Johnson1994, section 13.10.1]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SelectionBias {
    /// Frames without a value.
    pub left_out: usize,
    /// All frames.
    pub of: usize,
    /// Bound of the bias of the mean to either side, unit of the values; not a number where the values that were read tell no
    /// scatter, or too few were read.
    pub most: f64,
    /// The same in standard errors of the mean.
    pub in_standard_errors: f64,
    /// Largest share by which the standard deviation of all frames may exceed that of the values that were read: the frames without a
    /// value may be the highest and the lowest. With z cutting off half of the share q on either side, the others have the variance
    /// `1 - 2 z density(z) / (1 - q)` of that of all.
    pub most_scatter: f64,
    /// The same in standard errors of the standard deviation, `s / sqrt(2 (n - 1))` for n independent values.
    pub scatter_in_standard_errors: f64,
}

impl SelectionBias {
    /// Of a series that was read and the number of frames beside it without a value; none if there are none.
    pub fn new(read: &SeriesSummary, left_out: usize) -> Option<Self> {
        let of = read.n + left_out;
        let share = left_out as f64 / of as f64;
        let in_sd = in_standard_deviations(share);
        let scatter = 1.0 / variance_within(share).sqrt() - 1.0;
        (left_out > 0).then(|| Self {
            left_out,
            of,
            most: in_sd * read.sd,
            in_standard_errors: in_sd * read.n_effective.sqrt(),
            most_scatter: scatter,
            scatter_in_standard_errors: scatter * (2.0 * (read.n_effective - 1.0)).sqrt(),
        })
    }

    /// Whether the mean serves all the same: its bias is at most its standard error. Then even the worst case changes a result by
    /// no more than chance does in one of three series.
    pub fn is_borne(&self) -> bool {
        self.most.is_finite() && self.in_standard_errors <= 1.0
    }

    /// Whether the standard deviation serves all the same, by the same rule.
    pub fn scatter_is_borne(&self) -> bool {
        self.most.is_finite() && self.scatter_in_standard_errors <= 1.0
    }
}

/// Variance of normal values whose ends are cut off, half of the share on either side, over that of all.
fn variance_within(share: f64) -> f64 {
    let z = normal_upper_quantile(0.5 * share);
    1.0 - 2.0 * z * normal_density(z) / (1.0 - share)
}

/// The bound in standard deviations of the values that were read; not a number beyond [`LARGEST_SHARE`].
fn in_standard_deviations(share: f64) -> f64 {
    if share > LARGEST_SHARE {
        return f64::NAN;
    }
    let z = normal_upper_quantile(share);
    let lower = normal_density(z) / (1.0 - share);
    lower / (1.0 - z * lower - lower * lower).sqrt()
}

#[cfg(test)]
mod tests {
    use super::{LARGEST_SHARE, SelectionBias, in_standard_deviations};
    use probability::random_stream::Stream;
    use probability::{normal_density, normal_upper_quantile};
    use surface_profile::summarise;

    /// A series of a million normal values whose highest tenth cannot be read: what is left has a mean that is too low by the bound,
    /// to four standard errors of the mean.
    #[test]
    fn the_bound_is_what_the_loss_of_the_highest_frames_does() {
        let mut stream = Stream::new(7, "frames");
        let mut all: Vec<f64> = (0..1_000_000)
            .map(|_| 31.0 + 2.0 * stream.normal())
            .collect();
        let whole = all.iter().sum::<f64>() / 1e6;
        all.sort_by(f64::total_cmp);
        all.truncate(900_000);
        let n = 9e5;
        let mean = all.iter().sum::<f64>() / n;
        let sd = (all.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt();
        let bound = sd * in_standard_deviations(0.1);
        assert!((whole - mean - bound).abs() < 4.0 * 2.0 / 1e3, "{bound}");
    }

    /// Of the same series the highest and the lowest twentieth cannot be read: the standard deviation of all exceeds that of the others
    /// by the bound, to four of its standard errors, `1 / sqrt(2 10^6)` of it.
    #[test]
    fn the_scatter_grows_by_what_the_loss_of_both_ends_does() {
        let mut stream = Stream::new(8, "frames");
        let mut all: Vec<f64> = (0..1_000_000).map(|_| stream.normal()).collect();
        all.sort_by(f64::total_cmp);
        let [whole, middle] = [&all[..], &all[50_000..950_000]].map(|values| {
            let n = values.len() as f64;
            let mean = values.iter().sum::<f64>() / n;
            (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt()
        });
        let bias = SelectionBias::new(&summarise(&all[..9]).unwrap(), 1).unwrap();
        let found = whole / middle - 1.0;
        assert!(
            (found - bias.most_scatter).abs() < 4.0 * 1.3 / 2e6_f64.sqrt(),
            "{found}"
        );
    }

    /// Whatever else is lost, as far as it leaves an interval: never more than the loss of one end, for shares up to the largest.
    #[test]
    fn no_other_loss_of_the_same_share_does_more() {
        let density = |z: f64| {
            if z.is_finite() {
                normal_density(z)
            } else {
                0.0
            }
        };
        for share in [0.01, 0.1, LARGEST_SHARE] {
            let bound = in_standard_deviations(share);
            for k in 1..100 {
                let low = share * f64::from(k) / 100.0;
                let a = -normal_upper_quantile(low);
                let b = normal_upper_quantile(share - low);
                let mean = (density(a) - density(b)) / (1.0 - share);
                let variance =
                    1.0 + (a * density(a) - b * density(b)) / (1.0 - share) - mean * mean;
                let bias = mean.abs() / variance.sqrt();
                assert!(bias < bound, "{share}, {low}: {bias} for {bound}");
            }
        }
    }

    /// Of 20 independent frames one or two may be lost, and of many only a few: the standard error falls with their number. With a
    /// scatter of 0 nothing is known of those that were lost: copies of one photo have no mean of their own. One frame alone tells
    /// no scatter.
    #[test]
    fn more_frames_bear_a_smaller_share() {
        let borne = |n: usize, lost: usize| {
            let mut stream = Stream::new(3, "frames");
            let values: Vec<f64> = (0..n).map(|_| stream.normal()).collect();
            let mut read = summarise(&values).unwrap();
            read.n_effective = n as f64;
            SelectionBias::new(&read, lost).is_none_or(|bias| bias.is_borne())
        };
        assert!(borne(20, 0) && borne(18, 2) && !borne(16, 4), "of 20");
        assert!(borne(353, 7) && !borne(352, 8), "of 360");
        assert!(borne(4, 1) && !borne(3, 1) && !borne(1, 1), "of few");
    }
}
