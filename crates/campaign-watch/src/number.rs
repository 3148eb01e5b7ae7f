//! Numbers and times as people read them.

/// A number with about four digits.
pub(crate) fn short(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || (1e-3..1e5).contains(&size) {
        let decimals = if size == 0.0 {
            0
        } else if size < 0.01 {
            6
        } else if size < 0.1 {
            5
        } else if size < 1.0 {
            4
        } else if size < 10.0 {
            3
        } else if size < 100.0 {
            2
        } else {
            1
        };
        let text = format!("{value:.decimals$}");
        if text.contains('.') {
            let text = text.trim_end_matches('0').trim_end_matches('.');
            return text.replace('-', "−");
        }
        return text.replace('-', "−");
    }
    format!("{value:.3e}").replace('-', "−")
}

/// A time in the unit that reads best.
pub(crate) fn span(seconds: f64) -> String {
    let seconds = seconds.max(0.0);
    if seconds < 90.0 {
        format!("{seconds:.0} s")
    } else if seconds < 5400.0 {
        format!("{:.0} min", seconds / 60.0)
    } else {
        format!("{:.1} h", seconds / 3600.0)
    }
}

/// A number of things, in words.
pub(crate) fn counted(number: usize, one: &str, many: &str) -> String {
    if number == 1 {
        format!("1 {one}")
    } else {
        format!("{number} {many}")
    }
}

#[cfg(test)]
mod tests {
    use super::{counted, short, span};

    #[test]
    fn numbers_have_four_digits_and_times_their_unit() {
        let told = [0.0, 0.3, -38.6917, 1234.56, 2.0e-7, 0.00123456].map(short);
        assert_eq!(
            told,
            ["0", "0.3", "−38.69", "1234.6", "2.000e−7", "0.001235"]
        );
        assert_eq!(
            [89.0, 90.0, 7200.0, -1.0].map(span),
            ["89 s", "2 min", "2.0 h", "0 s"]
        );
        assert_eq!(counted(1, "run", "runs"), "1 run");
    }
}
