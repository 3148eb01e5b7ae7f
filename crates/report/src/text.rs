//! How much room a text takes; without the font this can only be an upper estimate.

/// Width of a text in px at a font size in px, for a wide sans-serif font.
pub(crate) fn text_width(text: &str, size: f64) -> f64 {
    text.chars().map(character_width).sum::<f64>() * size
}

/// Width of a character in units of the font size.
fn character_width(character: char) -> f64 {
    match character {
        'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' | ' ' => 0.34,
        'f' | 't' | 'r' | '(' | ')' | '[' | ']' | '/' | '-' => 0.41,
        '⁰'..='⁹' | '⁻' | '²' | '³' | '¹' => 0.42,
        'm' | 'w' | 'M' | 'W' | '@' | '%' => 0.95,
        '+' | '=' | '<' | '>' | '±' | '×' | '−' | '≤' | '≥' => 0.84,
        'A'..='Z' | '…' => 0.73,
        _ => 0.63,
    }
}

/// A text cut to a width in px. What is left out is replaced by an ellipsis in the middle, because
/// names in a row tend to differ at their ends.
pub(crate) fn fitted(text: &str, size: f64, width: f64) -> String {
    if text_width(text, size) <= width {
        return text.to_owned();
    }
    let characters: Vec<char> = text.chars().collect();
    let mut used = character_width('…') * size;
    let (mut head, mut tail) = (0, characters.len());
    while head < tail {
        // Head and tail grow by turns, the head first.
        let at_head = head <= characters.len() - tail;
        let next = if at_head {
            characters[head]
        } else {
            characters[tail - 1]
        };
        used += character_width(next) * size;
        if used > width {
            break;
        }
        if at_head {
            head += 1;
        } else {
            tail -= 1;
        }
    }
    let head: String = characters[..head].iter().collect();
    let tail: String = characters[tail..].iter().collect();
    format!("{}…{}", head.trim_end(), tail.trim_start())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_texts_are_cut_in_the_middle_to_the_width() {
        let text = "condition number 17";
        assert_eq!(fitted(text, 12.0, 1000.0), text);
        for width in [20.0, 45.0, 60.0, 100.0] {
            let cut = fitted(text, 12.0, width);
            assert!(text_width(&cut, 12.0) <= width, "{cut} in {width}");
            assert!(cut.contains('…') && text.starts_with(cut.split('…').next().unwrap()));
        }
        assert_eq!(fitted(text, 12.0, 60.0), "cond…17");
        assert_eq!(fitted("äöüßé", 12.0, 0.0), "…");
    }
}
