//! Numbers as people read them.

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

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn numbers_have_four_digits() {
        let told = [0.0, 0.3, -38.6917, 1234.56, 2.0e-7, 0.00123456].map(short);
        assert_eq!(
            told,
            ["0", "0.3", "−38.69", "1234.6", "2.000e−7", "0.001235"]
        );
    }
}
