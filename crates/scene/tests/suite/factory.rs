//! Seeds that a factory makes over time.

use crate::coarse;
use scene::{FillingLibrary, Keeper, Progress, Scene, run_on};
use serde_json::Value;

/// 56 coarse seeds in a slice of the study's drum, 300 of them a second.
fn drum() -> Scene {
    let mut scene = coarse::drum(&[
        ("apparatus.inner_diameter", "70 mm"),
        ("seed.0.count", "50"),
        ("seed.1.count", "6"),
        ("protocol.frames", "2"),
        ("protocol.frame_interval", "0.04 s"),
        ("time_s", "0.1"),
    ]);
    scene.protocol.insertion_rate = Some("300 1/s".parse().expect("a rate"));
    scene
}

/// Writes down what it is offered in each interval.
#[derive(Default)]
struct Diary {
    /// Time (s), kinds of the seeds and number of contacts.
    pages: Vec<(f64, Vec<u64>, usize)>,
}

impl Keeper for Diary {
    fn is_due(&mut self) -> bool {
        true
    }

    fn keep(&mut self, progress: &Progress) -> Result<(), String> {
        let value = serde_json::to_value(progress).map_err(|e| e.to_string())?;
        let bodies = &value["world"]["bodies"];
        let kinds = bodies["template"].as_array().expect("kinds");
        let kinds = kinds.iter().filter_map(Value::as_u64).collect();
        let contacts = value["world"]["pairs"].as_array().expect("contacts");
        self.pages.push((progress.time(), kinds, contacts.len()));
        Ok(())
    }
}

/// As many seeds are there as the rate says (one more or less by rounding and the length of a step), until
/// all are; the shapes are mixed: the flat ones are neither first nor last; and seeds appear without touching others:
/// in the first interval there is no contact.
#[test]
fn seeds_appear_at_the_rate_mixed_and_clear_of_each_other() {
    let mut diary = Diary::default();
    run_on(&drum(), &FillingLibrary::default(), 1, 1, None, &mut diary).expect("runs");
    let (mut seen, mut last) = (0, 0);
    for (time, kinds, _) in &diary.pages {
        let due = (300.0 * time).min(56.0);
        assert!(
            (kinds.len() as f64 - due).abs() <= 1.0,
            "{} at {time} s",
            kinds.len()
        );
        assert!(kinds.len() >= last, "a seed is gone at {time} s");
        last = kinds.len();
        seen += usize::from(last < 56);
    }
    assert_eq!(last, 56, "seeds at the end");
    assert!(seen >= 8, "{seen} intervals before the last seed");
    let kinds = &diary.pages.last().expect("a page").1;
    assert_eq!(kinds.iter().filter(|&&k| k == 1).count(), 6, "flat seeds");
    let at: Vec<usize> = (0..56).filter(|&k| kinds[k] == 1).collect();
    assert!(at[0] < 28 && at[5] >= 28, "flat seeds at {at:?}");
    assert_eq!(diary.pages[0].2, 0, "contacts in the first interval");
}

/// A rate that the apparatus cannot take: the seeds that find no place when all should rest are an error, not
/// missing.
#[test]
fn seeds_that_find_no_place_are_an_error() {
    let mut scene = drum();
    scene.seed[0].set_count(400);
    let error = run_on(
        &scene,
        &FillingLibrary::default(),
        1,
        1,
        None,
        &mut Diary::default(),
    );
    let error = error.unwrap_err().to_string();
    assert!(error.contains("406"), "{error}");
}
