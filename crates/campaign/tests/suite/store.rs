//! A store returns exactly the records that were put into it.

use crate::common::record;
use campaign::run_store::{Error, Lookup, Observation, Record, Store};
use serde_json::json;
use std::fs;

/// How a run ended up is kept with it, and is not part of the key: it is a result.
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
