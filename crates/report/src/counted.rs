//! A number of things in words.

/// A number before one of two words: `1 run`, `2 runs`.
pub fn counted(number: usize, one: &str, many: &str) -> String {
    format!("{number} {}", if number == 1 { one } else { many })
}

#[cfg(test)]
mod tests {
    use super::counted;

    #[test]
    fn one_thing_has_the_word_of_one() {
        let told = [0, 1, 2].map(|number| counted(number, "run", "runs"));
        assert_eq!(told, ["0 runs", "1 run", "2 runs"]);
    }
}
