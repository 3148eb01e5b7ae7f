//! Names of settings that a wrong name may have meant.

/// Most names that are told.
const MOST: usize = 6;

/// The names that a wrong one may have meant: those that hold its last word, or else those whose last word is nearest to
/// it.
pub(super) fn near(name: &str, known: &[String]) -> String {
    let last = last_word(name);
    let mut holding: Vec<&str> = known.iter().map(String::as_str).collect();
    holding.retain(|path| path.contains(last));
    if !last.is_empty() && !holding.is_empty() && holding.len() <= 2 * MOST {
        return holding.join(", ");
    }
    let mut by_distance: Vec<(usize, &str)> = known
        .iter()
        .map(|path| (least_distance(last, last_word(path)), path.as_str()))
        .collect();
    by_distance.sort_by_key(|(distance, _)| *distance);
    let nearest = by_distance.into_iter().take(MOST);
    nearest.map(|(_, path)| path).collect::<Vec<_>>().join(", ")
}

/// The last word of a dotted path.
fn last_word(path: &str) -> &str {
    path.rsplit('.').next().unwrap_or(path)
}

/// Distance of a word to another or to the nearest of its parts: `frction` is near `static_friction`.
fn least_distance(word: &str, other: &str) -> usize {
    let parts = other.split('_').map(|part| distance(word, part));
    parts.fold(distance(word, other), usize::min)
}

/// Number of letters to insert, drop or replace that turn one word into another (Levenshtein's distance).
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = i;
        let mut left = i + 1;
        for (place, to) in row.iter_mut().skip(1).zip(&b) {
            let replaced = diagonal + usize::from(from != *to);
            diagonal = *place;
            left = replaced.min(diagonal + 1).min(left + 1);
            *place = left;
        }
        if let Some(first) = row.first_mut() {
            *first = i + 1;
        }
    }
    row.last().copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::{distance, near};

    /// Distances counted by hand.
    #[test]
    fn a_slip_of_the_keyboard_finds_its_setting() {
        assert_eq!(distance("kitten", "sitting"), 3);
        assert_eq!((distance("", "abc"), distance("abc", "")), (3, 3));
        let known = ["contact.a-b.restitution", "camera.pixels", "rpm"].map(str::to_owned);
        assert!(near("restituton", &known).starts_with("contact.a-b.restitution"));
        let friction = ["camera.pixels", "a-b.static_friction"].map(str::to_owned);
        assert!(near("frction", &friction).starts_with("a-b.static_friction"));
        assert_eq!(near("camera.pixels", &known), "camera.pixels");
    }
}
