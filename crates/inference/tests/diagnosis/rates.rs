//! How often the rules of the diagnosis are right, in campaigns drawn from the design of a problem: docs/trials.md.

use dev_support::fixture_files::fixture;
use inference::diagnosis::{Problem, ProblemFile, TrialRow, Truth, trials, usual_truths};

/// Campaigns of each truth.
const NUMBER: usize = 100;

/// Sum of a count over rows.
fn sum(rows: &[&TrialRow], count: fn(&TrialRow) -> usize) -> f64 {
    rows.iter().map(|row| count(row)).sum::<usize>() as f64
}

/// Share of the campaigns that get a false name, in percent; "-" without campaigns.
fn false_names(rows: &[&TrialRow]) -> String {
    match sum(rows, |row| row.trials) {
        0.0 => "-".to_owned(),
        all => format!("{:.1}", 100.0 * sum(rows, |row| row.false_name) / all),
    }
}

/// Prints the table.
#[test]
#[ignore = "minutes: `trials/checks.sh diagnosis-rates`"]
fn table_of_rates() {
    println!(
        "| problem | strength | hidden effect in the named set, % | in the set where something is named, % | \
         false name for an effect outside the library, %: all, with a twin, without |\n|---|--:|--:|--:|---|"
    );
    for name in ["drum", "library", "single", "tie"] {
        let text = std::fs::read_to_string(fixture("diagnosis").join(name).join("problem.json"));
        let file: ProblemFile = serde_json::from_str(&text.unwrap()).unwrap();
        let problem = Problem::try_from(file).unwrap();
        let nothing = trials(&problem, &[Truth::Nothing], NUMBER, 1, 0).unwrap();
        for strength in [4.0, 9.0] {
            let truths = usual_truths(&problem, strength).unwrap();
            let rows = trials(&problem, &truths, NUMBER, 1, 0).unwrap();
            let of = |wanted: fn(&Truth) -> bool| -> Vec<&TrialRow> {
                rows.iter().filter(|row| wanted(&row.truth)).collect()
            };
            let inside = of(|truth| matches!(truth, Truth::Effect { .. }));
            let right = sum(&inside, |row| row.named + row.tied);
            let named = right + sum(&inside, |row| row.false_name);
            let outside =
                of(|truth| matches!(truth, Truth::TakenOut { .. } | Truth::Outsider { .. }));
            let (twins, others): (Vec<_>, Vec<_>) = outside
                .iter()
                .partition(|row| row.nearest.as_ref().is_some_and(|nearest| nearest.twin));
            println!(
                "| {name} | {strength} | {:.1} | {:.1} | {}, {}, {} |",
                100.0 * right / sum(&inside, |row| row.trials),
                100.0 * right / named,
                false_names(&outside),
                false_names(&twins),
                false_names(&others),
            );
        }
        println!(
            "{name}: reported with nothing hidden in {:.1} %",
            100.0 * nothing[0].alarm()
        );
    }
}
