//! Which settings a column is said to set.

use crate::problem::{Problem, Problems};
use std::collections::BTreeMap;

/// The binding of a column to settings.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Bind {
    /// Names of the settings.
    pub(super) names: Vec<String>,
    /// Unit of plain numbers, where one is stated.
    pub(super) unit: Option<String>,
}

/// Reads bindings of columns, `COLUMN=PATH[,PATH]` each.
pub(super) fn binds(texts: &[String], problems: &mut Problems) -> BTreeMap<String, Bind> {
    let mut binds = BTreeMap::new();
    for text in texts {
        let mut wrong = |problem: String| {
            problems.add(Problem {
                file: "--bind".to_owned(),
                line: None,
                what: format!("'{text}'"),
                problem,
            });
        };
        let parts = text.split_once('=');
        let bind = parts.and_then(|(column, paths)| {
            let (paths, unit) = name_and_unit(paths);
            let names: Vec<String> = paths.split(',').map(|p| p.trim().to_owned()).collect();
            let column = column.trim().to_owned();
            let complete = !column.is_empty() && names.iter().all(|name| !name.is_empty());
            complete.then_some((column, Bind { names, unit }))
        });
        let Some((column, bind)) = bind else {
            wrong(
                "does not say which settings a column sets: write COLUMN=PATH, such as \
                 B=contact.seed-seed.static_friction"
                    .to_owned(),
            );
            continue;
        };
        if binds.contains_key(&column) {
            wrong(format!(
                "is the second setting of column '{column}': name all its settings at once, {column}=PATH,PATH"
            ));
            continue;
        }
        binds.insert(column, bind);
    }
    binds
}

/// A name and the unit in brackets behind it: `apparatus.speed [rpm]`.
pub(super) fn name_and_unit(text: &str) -> (&str, Option<String>) {
    let text = text.trim();
    let in_brackets = text.strip_suffix(']').and_then(|t| t.rsplit_once('['));
    match in_brackets {
        Some((name, unit)) if !unit.trim().is_empty() => {
            (name.trim(), Some(unit.trim().to_owned()))
        }
        _ => (text, None),
    }
}

#[cfg(test)]
mod tests {
    use super::{Bind, binds, name_and_unit};
    use crate::problem::Problems;

    #[test]
    fn a_column_may_set_several_settings_in_one_unit() {
        let mut problems = Problems::default();
        let texts = ["W = apparatus.speed [rpm]", "B=a.b,c.d"].map(str::to_owned);
        let read = binds(&texts, &mut problems);
        let expected = |names: &[&str], unit: Option<&str>| Bind {
            names: names.iter().map(|n| (*n).to_owned()).collect(),
            unit: unit.map(str::to_owned),
        };
        assert_eq!(read["W"], expected(&["apparatus.speed"], Some("rpm")));
        assert_eq!(read["B"], expected(&["a.b", "c.d"], None));
        assert_eq!(problems.count(), 0);
        let wrong = ["B", "=a", "B=", "B=a,,b", "C=a", "C=b"].map(str::to_owned);
        binds(&wrong, &mut problems);
        assert_eq!(problems.count(), 5, "all but the first C");
    }

    #[test]
    fn a_unit_in_brackets_is_taken_off_a_name() {
        assert_eq!(name_and_unit("a.b [mm]"), ("a.b", Some("mm".to_owned())));
        assert_eq!(name_and_unit("a.b"), ("a.b", None));
        assert_eq!(name_and_unit("a.b []"), ("a.b []", None));
    }
}
