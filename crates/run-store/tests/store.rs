//! The store under kill, damage and concurrent writers.

use run_store::{Error, Lookup, Observation, Record, Store};
use serde_json::json;
use std::fs;

/// A record with numbers whose last bits matter.
fn record(seed: u64) -> Record {
    let angle = Observation {
        mean: 38.870000000000005,
        sd: Some(0.1 + 0.2),
        n: 10,
        unit: "deg".into(),
    };
    Record::new(
        "0.1.0",
        json!({"rpm": 14.999999999999998, "model": "drum"}),
        seed,
    )
    .expect("the record is sound")
    .with_observable("angle", angle)
    .expect("the record is sound")
    .with_details(json!({"wall_s": 1.25, "series": [0.1, 2.2250738585072014e-308]}))
}

/// How a run ended up is kept with it, and is no part of the key: it is a result.
#[test]
fn the_regime_survives_the_store_and_leaves_the_key_alone() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let plain = record(1);
    assert_eq!(plain.regime(), None);
    let rolling = plain.clone().with_regime(Some("rolling".to_owned()));
    assert_eq!(rolling.key(), plain.key());
    store.put(&rolling).unwrap();
    let Lookup::Found(read) = store.get(plain.key()).unwrap() else {
        panic!("the record is there");
    };
    assert_eq!(read.regime(), Some("rolling"));
    assert_eq!(read, rolling);
}

#[test]
fn record_reads_back_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let written = record(1);
    assert_eq!(store.get(written.key()).unwrap(), Lookup::Absent);
    store.put(&written).unwrap();
    assert_eq!(
        store.get(written.key()).unwrap(),
        Lookup::Found(written.clone())
    );
    assert_eq!(store.keys().unwrap(), vec![written.key().to_owned()]);
}

/// A killed writer leaves an aside file with half a record: never read, gone after opening.
#[test]
fn leftover_of_a_killed_writer_is_ignored_and_swept() {
    let folder = tempfile::tempdir().unwrap();
    let key = record(1).key().to_owned();
    let leftover = folder.path().join(format!(".{key}.99999.0.aside"));
    let store = Store::open(folder.path()).unwrap();
    fs::write(&leftover, "{\"schema\": 1, \"ke").unwrap();
    assert_eq!(store.get(&key).unwrap(), Lookup::Absent);
    assert!(store.keys().unwrap().is_empty(), "an aside file has a key");
    Store::open(folder.path()).unwrap();
    assert!(!leftover.exists(), "the leftover is still there");
}

/// The lock of a living writer keeps its aside file from being swept.
#[test]
fn aside_file_of_a_living_writer_stays() {
    let folder = tempfile::tempdir().unwrap();
    let aside = folder
        .path()
        .join(format!(".{}.1.0.aside", record(1).key()));
    let file = fs::File::create(&aside).unwrap();
    file.lock().unwrap();
    Store::open(folder.path()).unwrap();
    assert!(aside.exists(), "a file in use was swept");
}

/// Writers of the same key, and openers that sweep, at the same time: no error, no half record,
/// no aside file left.
#[test]
fn writers_of_one_key_do_each_other_no_harm() {
    let folder = tempfile::tempdir().unwrap();
    let written = record(1);
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                for _ in 0..25 {
                    let store = Store::open(folder.path()).unwrap();
                    store.put(&written).unwrap();
                    assert_eq!(
                        store.get(written.key()).unwrap(),
                        Lookup::Found(written.clone())
                    );
                }
            });
        }
    });
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn damaged_record_is_an_error_that_names_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let written = record(1);
    store.put(&written).unwrap();
    let path = folder.path().join(format!("{}.json", written.key()));
    let whole = fs::read(&path).unwrap();
    fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    let error = store.get(written.key()).unwrap_err();
    assert!(
        matches!(&error, Error::Damaged { path: p, .. } if *p == path),
        "{error}"
    );
}

#[test]
fn record_under_a_wrong_name_is_absent_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let (one, other) = (record(1), record(2));
    store.put(&one).unwrap();
    let wrong = folder.path().join(format!("{}.json", other.key()));
    fs::rename(folder.path().join(format!("{}.json", one.key())), &wrong).unwrap();
    assert_eq!(
        store.get(other.key()).unwrap(),
        Lookup::Mismatch {
            path: wrong,
            content_key: one.key().to_owned()
        }
    );
    store.put(&other).unwrap();
    assert_eq!(
        store.get(other.key()).unwrap(),
        Lookup::Found(other.clone())
    );
}

#[test]
fn edited_input_is_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let written = record(1);
    store.put(&written).unwrap();
    let path = folder.path().join(format!("{}.json", written.key()));
    let text = fs::read_to_string(&path)
        .unwrap()
        .replace("14.999999999999998", "15.0");
    fs::write(&path, text).unwrap();
    let found = store.get(written.key()).unwrap();
    assert!(matches!(found, Lookup::Mismatch { .. }), "{found:?}");
}

#[test]
fn record_of_another_schema_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let key = record(1).key().to_owned();
    fs::write(
        folder.path().join(format!("{key}.json")),
        "{\"schema\": 99, \"x\": 1}",
    )
    .unwrap();
    let error = store.get(&key).unwrap_err();
    assert!(
        matches!(error, Error::OtherSchema { found: 99, .. }),
        "{error}"
    );
}

#[test]
fn foreign_file_is_reported_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    fs::write(folder.path().join("notes.txt"), "mine").unwrap();
    let error = store.keys().unwrap_err();
    assert!(error.to_string().contains("notes.txt"), "{error}");
}

#[test]
fn key_that_is_a_path_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let error = store.get("../secret").unwrap_err();
    assert!(matches!(error, Error::BadKey { .. }), "{error}");
}

#[test]
fn numbers_that_are_not_finite_are_refused() {
    let bad = |mean, sd| {
        let result = Observation {
            mean,
            sd,
            n: 2,
            unit: "deg".into(),
        };
        record(1).with_observable("angle", result).is_err()
    };
    assert!(bad(f64::NAN, Some(1.0)), "mean NaN");
    assert!(bad(1.0, Some(f64::INFINITY)), "sd infinite");
    assert!(bad(1.0, Some(-0.1)), "sd negative");
    assert!(!bad(1.0, None), "an undefined sd is allowed");
    assert!(
        Record::new("1", json!({"x": f64::INFINITY}), 1).is_err(),
        "input infinite"
    );
}
