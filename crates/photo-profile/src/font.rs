//! A font of digits, capital letters and signs, three by five dots each.

/// Dots of a character, five rows from the top, the lowest three bits from the left; small letters as capitals, `None`
/// for a character that is not in the font.
pub(crate) fn dots(character: char) -> Option<[u8; 5]> {
    let rows = match character.to_ascii_uppercase() {
        '0' => "###/#.#/#.#/#.#/###",
        '1' => ".#./##./.#./.#./###",
        '2' => "###/..#/###/#../###",
        '3' => "###/..#/###/..#/###",
        '4' => "#.#/#.#/###/..#/..#",
        '5' => "###/#../###/..#/###",
        '6' => "###/#../###/#.#/###",
        '7' => "###/..#/.#./.#./.#.",
        '8' => "###/#.#/###/#.#/###",
        '9' => "###/#.#/###/..#/###",
        'A' => ".#./#.#/###/#.#/#.#",
        'B' => "##./#.#/##./#.#/##.",
        'C' => ".##/#../#../#../.##",
        'D' => "##./#.#/#.#/#.#/##.",
        'E' => "###/#../##./#../###",
        'F' => "###/#../##./#../#..",
        'G' => ".##/#../#.#/#.#/.##",
        'H' => "#.#/#.#/###/#.#/#.#",
        'I' => "###/.#./.#./.#./###",
        'J' => "..#/..#/..#/#.#/.#.",
        'K' => "#.#/#.#/##./#.#/#.#",
        'L' => "#../#../#../#../###",
        'M' => "#.#/###/###/#.#/#.#",
        'N' => "##./#.#/#.#/#.#/#.#",
        'O' => ".#./#.#/#.#/#.#/.#.",
        'P' => "##./#.#/##./#../#..",
        'Q' => ".#./#.#/#.#/.#./..#",
        'R' => "##./#.#/##./#.#/#.#",
        'S' => ".##/#../.#./..#/##.",
        'T' => "###/.#./.#./.#./.#.",
        'U' => "#.#/#.#/#.#/#.#/###",
        'V' => "#.#/#.#/#.#/#.#/.#.",
        'W' => "#.#/#.#/###/###/#.#",
        'X' => "#.#/#.#/.#./#.#/#.#",
        'Y' => "#.#/#.#/.#./.#./.#.",
        'Z' => "###/..#/.#./#../###",
        '.' => ".../.../.../.../.#.",
        ',' => ".../.../.../.#./#..",
        ';' => ".../.#./.../.#./#..",
        ':' => ".../.#./.../.#./...",
        '-' => ".../.../###/.../...",
        '(' => ".#./#../#../#../.#.",
        ')' => ".#./..#/..#/..#/.#.",
        '\'' => ".#./.#./.../.../...",
        '%' => "#.#/..#/.#./#../#.#",
        ' ' => ".../.../.../.../...",
        '\u{b0}' => "###/#.#/###/.../...",
        _ => return None,
    };
    let mut dots = [0; 5];
    for (row, bits) in rows.split('/').zip(&mut dots) {
        *bits = row.chars().fold(0, |b, dot| 2 * b + u8::from(dot == '#'));
    }
    Some(dots)
}

/// A text in lines of at most so many characters, broken at spaces; a longer word has a line of its own.
pub(crate) fn lines(text: &str, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= most => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::{dots, lines};

    /// The digits 4 and a letter as they are drawn; three dots wide, five rows.
    #[test]
    fn characters_have_their_dots() {
        assert_eq!(dots('4'), Some([0b101, 0b101, 0b111, 0b001, 0b001]));
        assert_eq!(dots('t'), Some([0b111, 0b010, 0b010, 0b010, 0b010]));
        assert_eq!(dots('\u{fc}'), None);
    }

    #[test]
    fn lines_break_at_spaces() {
        assert_eq!(lines("a bc  def g", 4), ["a bc", "def", "g"]);
        assert_eq!(lines("abcdefg h", 4), ["abcdefg", "h"]);
        assert!(lines("", 4).is_empty());
    }
}
