//! The command line and the environment of a program that is run with values.

use std::collections::BTreeMap;

/// An argument that represents all values as `name=value`.
pub(crate) const ARGUMENTS: &str = "{arguments}";

/// Names of the places `{name}` in an entry of a command.
pub(crate) fn places(entry: &str) -> impl Iterator<Item = &str> {
    let parts = entry.split('{').skip(1);
    parts.filter_map(|part| part.split_once('}').map(|(name, _)| name))
}

/// The command line of a run.
pub(crate) fn arguments(command: &[String], values: &BTreeMap<String, String>) -> Vec<String> {
    let all = || values.iter().map(|(name, value)| format!("{name}={value}"));
    let mut line = Vec::new();
    for entry in command {
        if entry == ARGUMENTS {
            line.extend(all());
            continue;
        }
        let mut filled = entry.clone();
        for (name, value) in values {
            filled = filled.replace(&format!("{{{name}}}"), value);
        }
        line.push(filled);
    }
    if command.iter().all(|entry| places(entry).next().is_none()) {
        line.extend(all());
    }
    line
}

/// The environment variable of a value: `SEEDLOOP_` and its name in capitals, what is neither letter nor digit as `_`.
pub fn variable(name: &str) -> String {
    let letter = |c: char| match c {
        c if c.is_ascii_alphanumeric() => c.to_ascii_uppercase(),
        _ => '_',
    };
    format!("SEEDLOOP_{}", name.chars().map(letter).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::{arguments, variable};
    use std::collections::BTreeMap;

    #[test]
    fn values_take_their_places_or_come_last() {
        let values: BTreeMap<String, String> = [("mu", "0.3"), ("seed", "1")]
            .map(|(k, v)| (k.to_owned(), v.to_owned()))
            .into();
        let line = |command: &[&str]| {
            let command: Vec<String> = command.iter().map(|c| (*c).to_owned()).collect();
            arguments(&command, &values).join(" ")
        };
        assert_eq!(line(&["run"]), "run mu=0.3 seed=1");
        assert_eq!(line(&["run", "-var", "f", "{mu}"]), "run -var f 0.3");
        assert_eq!(line(&["run", "{arguments}", "x"]), "run mu=0.3 seed=1 x");
        assert_eq!(variable("apparatus.speed"), "SEEDLOOP_APPARATUS_SPEED");
    }
}
