//! Probable intention behind a line that is not valid TOML.

/// Remedy for a common mistake in a line that a parser refused: a decimal comma, a point without a digit before it, or a
/// value with its unit or a word without quotes. `None` if the line has no such mistake.
///
/// Call it only with a refused line: in a valid line, `[1,5]` is two numbers.
pub fn toml_slip(line: &str) -> Option<String> {
    let code = without_text(line);
    let letters: Vec<char> = code.chars().collect();
    let digit = |k: Option<usize>| {
        k.and_then(|k| letters.get(k))
            .is_some_and(char::is_ascii_digit)
    };
    let is = |k: usize, letter: char| letters[k] == letter;
    let mut all = 0..letters.len();
    if all
        .clone()
        .any(|k| is(k, ',') && digit(k.checked_sub(1)) && digit(Some(k + 1)))
    {
        return Some("write decimals with a point, as in 0.25".into());
    }
    if all.any(|k| is(k, '.') && !digit(k.checked_sub(1)) && digit(Some(k + 1))) {
        return Some("write the digit before the point, as in 0.25".into());
    }
    values(&code).find_map(bare)
}

/// The line without its comment, and with nothing between its quotes.
fn without_text(line: &str) -> String {
    let mut code = String::new();
    let mut quote = None;
    for letter in line.chars() {
        match quote {
            Some(end) if letter == end => quote = None,
            Some(_) => continue,
            None if letter == '#' => break,
            None if letter == '"' || letter == '\'' => quote = Some(letter),
            None => {}
        }
        code.push(letter);
    }
    code
}

/// The text after each `=`, up to the next separator.
fn values(code: &str) -> impl Iterator<Item = &str> {
    let behind = code.split('=').skip(1);
    behind.filter_map(|rest| rest.split([',', '}', ']', '[', '{']).next().map(str::trim))
}

/// The mistake in a value without quotes.
fn bare(value: &str) -> Option<String> {
    // A quote that was not opened stands at the end.
    let value = value.trim_end_matches(['"', '\'']);
    let first = value.chars().next()?;
    let word = first.is_alphabetic() && !["true", "false", "inf", "nan"].contains(&value);
    let with_unit = first.is_ascii_digit() && value.parse::<f64>().is_err();
    (word || with_unit).then(|| format!("write it in quotes, \"{value}\""))
}

#[cfg(test)]
mod tests {
    use super::toml_slip;

    /// Each mistake is reported with its correction; text in quotes or in a comment is never a mistake.
    #[test]
    fn the_usual_slips_have_a_way_out() {
        for (line, words) in [
            ("fill_level = 0,3   # of \"x\"", "decimals with a point"),
            (
                "angle_deg = { mean = 34.1, sd = 0,5, n = 9 }",
                "decimals with a point",
            ),
            ("low = .2", "digit before the point"),
            ("kind = command", "\"command\""),
            ("role = fit # or check", "\"fit\""),
            ("width = 30 mm", "\"30 mm\""),
            ("width = 30 mm\" # a slice", "\"30 mm\""),
            ("condition = { rpm = fast }", "\"fast\""),
        ] {
            let told = toml_slip(line).unwrap_or_default();
            assert!(told.contains(words), "{line}: {told}");
        }
        for line in [
            "name = \"0,3 mm\" x",
            "high = 0.3 # not 0,3",
            "ramp = true, x",
            "step = 1e-3, x",
            "[[measured]",
            "",
        ] {
            assert_eq!(toml_slip(line), None, "{line}");
        }
    }
}
