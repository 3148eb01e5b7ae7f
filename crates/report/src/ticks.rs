//! Round numbers for axes.

use crate::text::text_width;

/// Part of a number line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Domain {
    /// Lower end.
    pub(crate) low: f64,
    /// Upper end, above the lower.
    pub(crate) high: f64,
}

impl Domain {
    /// What holds all values with some room on both sides; a lone value gets room as well.
    pub(crate) fn around(values: impl IntoIterator<Item = f64>) -> Self {
        let tight = Self::tight(values);
        let room = 0.06 * (tight.high - tight.low);
        Self {
            low: tight.low - room,
            high: tight.high + room,
        }
    }

    /// What just holds all values; a lone value still gets room.
    pub(crate) fn tight(values: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = values
            .into_iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                (low.min(value), high.max(value))
            });
        if low > high {
            return Self {
                low: 0.0,
                high: 1.0,
            };
        }
        let least = f64::max(low.abs(), high.abs()) * 1e-9;
        if high - low > least {
            return Self { low, high };
        }
        let room = if low == 0.0 { 1.0 } else { 0.1 * low.abs() };
        Self {
            low: low - room,
            high: high + room,
        }
    }

    /// Place of a value: 0 at the first end, 1 at the last.
    pub(crate) fn share(self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }
}

/// Marks of an axis and what stands at them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ticks {
    /// Places in ascending order.
    pub(crate) values: Vec<f64>,
    /// Texts, one a value, in units of 10 to the power of `exponent`.
    pub(crate) labels: Vec<String>,
    /// Power of ten that belongs into the axis title, a multiple of 3.
    pub(crate) exponent: i32,
}

impl Ticks {
    /// About `count` ticks at multiples of 1, 2, 2.5 or 5 times a power of ten.
    pub(crate) fn of(domain: Domain, count: f64) -> Self {
        let step = nice_step((domain.high - domain.low) / count);
        // Multiples are counted as whole numbers so that rounding does not add up.
        let slack = 1e-9;
        let mut multiple = (domain.low / step - slack).ceil();
        let mut values = Vec::new();
        while multiple * step <= domain.high + slack * step && values.len() < 1000 {
            values.push(multiple * step);
            multiple += 1.0;
        }
        let largest = domain.low.abs().max(domain.high.abs());
        let exponent = exponent_of(largest);
        let unit = 10f64.powi(exponent);
        let decimals = decimals_of(step / unit);
        let labels = values
            .iter()
            .map(|value| plain(value / unit, decimals))
            .collect();
        Self {
            values,
            labels,
            exponent,
        }
    }

    /// One tick a name, at 0, 1, 2 and so on.
    pub(crate) fn names<'a>(names: impl IntoIterator<Item = &'a str>) -> Self {
        let labels: Vec<String> = names.into_iter().map(str::to_owned).collect();
        let values = (0..labels.len()).map(|index| index as f64).collect();
        Self {
            values,
            labels,
            exponent: 0,
        }
    }

    /// Width of the widest label at a font size, px.
    pub(crate) fn width(&self, size: f64) -> f64 {
        self.labels
            .iter()
            .map(|label| text_width(label, size))
            .fold(0.0, f64::max)
    }
}

/// Smallest of 1, 2, 2.5 and 5 times a power of ten that is not below `least`.
pub(crate) fn nice_step(least: f64) -> f64 {
    let power = 10f64.powi(floor_log10(least));
    let factor = [1.0, 2.0, 2.5, 5.0]
        .into_iter()
        .find(|factor| factor * power >= least * (1.0 - 1e-9))
        .unwrap_or(10.0);
    factor * power
}

/// Largest whole number not above the common logarithm.
#[expect(
    clippy::cast_possible_truncation,
    reason = "exponents of f64 lie within -324 and 308"
)]
fn floor_log10(value: f64) -> i32 {
    value.abs().max(f64::MIN_POSITIVE).log10().floor() as i32
}

/// Power of ten, a multiple of 3, that keeps labels short; 0 between 0.01 and 100 000.
fn exponent_of(largest: f64) -> i32 {
    let magnitude = floor_log10(largest);
    if largest == 0.0 || (-2..=4).contains(&magnitude) {
        0
    } else {
        magnitude.div_euclid(3) * 3
    }
}

/// Decimals that a multiple of the step needs.
fn decimals_of(step: f64) -> usize {
    (0..12)
        .find(|&decimals| {
            let scaled = step * 10f64.powi(decimals);
            (scaled - scaled.round()).abs() < 1e-6 * scaled
        })
        .map_or(12, |decimals| usize::try_from(decimals).unwrap_or(0))
}

/// A number with a fixed count of decimals, a true minus sign and no negative zero.
pub(crate) fn plain(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().all(|byte| byte == b'0' || byte == b'.') => {
            digits.to_owned()
        }
        Some(digits) => format!("−{digits}"),
        None => text,
    }
}

/// A number with about three digits that matter, for notes beside bars and lines.
pub(crate) fn short(value: f64) -> String {
    let magnitude = floor_log10(value);
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(-4..=5).contains(&magnitude) {
        let mantissa = value / 10f64.powi(magnitude);
        return format!("{}×10{}", plain(mantissa, 2), superscript(magnitude));
    }
    let decimals = usize::try_from(2 - magnitude).unwrap_or(0);
    plain(value, decimals)
}

/// A whole number in raised digits.
pub(crate) fn superscript(number: i32) -> String {
    number
        .to_string()
        .chars()
        .map(|character| match character {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            '4' => '⁴',
            '5' => '⁵',
            '6' => '⁶',
            '7' => '⁷',
            '8' => '⁸',
            '9' => '⁹',
            _ => '⁰',
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers_inside_the_domain() {
        let ticks = Ticks::of(
            Domain {
                low: 33.7,
                high: 41.2,
            },
            6.0,
        );
        assert_eq!(ticks.labels, ["34", "36", "38", "40"]);
        let ticks = Ticks::of(
            Domain {
                low: -0.31,
                high: 0.3,
            },
            6.0,
        );
        assert_eq!(ticks.labels, ["−0.2", "0.0", "0.2"]);
        let ticks = Ticks::of(
            Domain {
                low: 0.0,
                high: 1.0,
            },
            4.0,
        );
        assert_eq!(ticks.labels, ["0.00", "0.25", "0.50", "0.75", "1.00"]);
        assert_eq!(ticks.values, [0.0, 0.25, 0.5, 0.75, 1.0]);
    }

    #[test]
    fn every_step_is_one_two_two_and_a_half_or_five_times_a_power_of_ten() {
        for index in 0..400 {
            let least = 10f64.powf(f64::from(index) * 0.05 - 10.0);
            let step = nice_step(least);
            // Never finer than asked, and never coarser than the widest gap (2.5 to 5) allows.
            assert!(
                step >= least * (1.0 - 1e-8) && step <= 2.0 * least * (1.0 + 1e-8),
                "{least}"
            );
            let mantissa = step / 10f64.powi(floor_log10(step * (1.0 + 1e-12)));
            let nearest = [1.0, 2.0, 2.5, 5.0, 10.0]
                .into_iter()
                .map(|factor: f64| (factor - mantissa).abs())
                .fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-9, "{step} from {least}");
        }
    }

    #[test]
    fn labels_tell_neighbouring_ticks_apart_at_every_size() {
        for index in 0..600 {
            let centre = f64::from(index % 7) - 3.0;
            let span = 10f64.powf(f64::from(index) / 20.0 - 15.0);
            let low = centre * span;
            let ticks = Ticks::of(
                Domain {
                    low,
                    high: low + span,
                },
                6.0,
            );
            assert!(ticks.values.len() >= 3, "{span}: {ticks:?}");
            for pair in ticks.labels.windows(2) {
                assert_ne!(pair[0], pair[1], "{span}: {ticks:?}");
            }
            assert!(ticks.width(12.0) < 70.0, "{span}: {ticks:?}");
        }
    }

    #[test]
    fn small_and_large_numbers_carry_their_power_of_ten_apart() {
        let ticks = Ticks::of(
            Domain {
                low: 0.0,
                high: 4e-6,
            },
            5.0,
        );
        assert_eq!((ticks.exponent, ticks.labels[1].as_str()), (-6, "1"));
        let ticks = Ticks::of(
            Domain {
                low: 0.0,
                high: 3e8,
            },
            4.0,
        );
        assert_eq!((ticks.exponent, ticks.labels[1].as_str()), (6, "100"));
        assert_eq!(superscript(-6), "⁻⁶");
    }

    #[test]
    fn numbers_have_a_true_minus_and_no_negative_zero() {
        assert_eq!(plain(-0.001, 2), "0.00");
        assert_eq!(plain(-1.25, 1), "−1.2");
        assert_eq!(short(0.0), "0");
        assert_eq!(short(41.264), "41.3");
        assert_eq!(short(-0.012345), "−0.0123");
        assert_eq!(short(123456.0), "123456");
        assert_eq!(short(2.5e-7), "2.50×10⁻⁷");
    }

    #[test]
    fn domain_of_one_value_or_none_still_has_a_length() {
        for values in [vec![], vec![0.0], vec![38.9], vec![-2.0, -2.0]] {
            let domain = Domain::around(values.iter().copied());
            assert!(domain.high > domain.low, "{values:?}");
            assert!(
                values
                    .iter()
                    .all(|&value| domain.low < value && value < domain.high)
            );
        }
    }
}
