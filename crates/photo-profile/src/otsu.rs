//! The threshold between two classes of grey levels.

/// A threshold in a histogram of 256 levels: values above it belong to the upper class.
///
/// # Formula
/// The level that maximises `w0 w1 (m1 - m0)^2`, w and m being weight and mean of the classes;
/// returned is the middle `(m0 + m1) / 2` of the class means at that level, which is the half
/// level of a blurred edge and does not depend on how grey levels are rounded.
///
/// # Source
/// `[Otsu1979, eq. 18]`; the middle of the means instead of the level is ours. Counts are u64 and
/// sums f64, so that no picture size overflows.
///
/// `None` for fewer than two occupied levels.
pub fn otsu_threshold(histogram: &[u64; 256]) -> Option<f64> {
    let total: u64 = histogram.iter().sum();
    let sum: f64 = histogram
        .iter()
        .enumerate()
        .map(|(g, n)| g as f64 * *n as f64)
        .sum();
    let (mut n_low, mut sum_low) = (0_u64, 0.0);
    let (mut best, mut middle) = (0.0, None);
    for (level, n) in histogram.iter().enumerate() {
        n_low += n;
        sum_low += level as f64 * *n as f64;
        let n_high = total - n_low;
        if n_low == 0 || n_high == 0 {
            continue;
        }
        let (low, high) = (sum_low / n_low as f64, (sum - sum_low) / n_high as f64);
        let between = n_low as f64 * n_high as f64 * (high - low) * (high - low);
        if between > best {
            best = between;
            middle = Some(0.5 * (low + high));
        }
    }
    middle
}

#[cfg(test)]
mod tests {
    use super::otsu_threshold;

    /// Two spikes: the middle is exact. Counts of 4e9 overflow 32 bits, as 255 times them does.
    #[test]
    fn two_spikes_are_parted_in_the_middle_whatever_their_counts() {
        let mut histogram = [0; 256];
        histogram[40] = 4_000_000_000;
        histogram[250] = 9_000_000_000;
        assert_eq!(otsu_threshold(&histogram), Some(145.0));
    }

    #[test]
    fn one_level_has_no_threshold() {
        let mut histogram = [0; 256];
        histogram[7] = 10;
        assert_eq!(otsu_threshold(&histogram), None);
        assert_eq!(otsu_threshold(&[0; 256]), None);
    }
}
