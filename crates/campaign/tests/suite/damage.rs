//! Nothing that was altered after it was written is believed, and nothing is thrown away.
#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a failed step fails its test"
)]

use crate::common::record;
use campaign::run_store::{
    Lookup, Observation, Record, SCHEMA, Store, seal, seal_text, seal_without, unseal, unseal_text,
};
use serde_json::json;
use std::fs;
use std::path::PathBuf;

/// A folder with one record in it, and the file of the record.
struct Kept {
    folder: tempfile::TempDir,
    store: Store,
    record: Record,
    file: PathBuf,
}

impl Kept {
    fn new(record: Record) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        store.put(&record).unwrap();
        let file = folder.path().join(format!("{}.json", record.key()));
        Self {
            folder,
            store,
            record,
            file,
        }
    }

    /// Why the store does not believe the file.
    fn reason(&self) -> String {
        match self.store.get(self.record.key()).unwrap() {
            Lookup::Damaged { path, reason } => {
                assert_eq!(path, self.file);
                reason
            }
            other => panic!("{other:?}"),
        }
    }

    /// Changes the text of the file.
    fn edit(&self, change: impl Fn(String) -> String) {
        let text = fs::read_to_string(&self.file).unwrap();
        let changed = change(text.clone());
        assert_ne!(changed, text, "the edit met nothing");
        fs::write(&self.file, changed).unwrap();
    }

    /// Sets the file aside and gives its new name without the key.
    fn set_aside(&self) -> String {
        let away = self.store.set_aside(&self.file).unwrap().unwrap();
        let name = away.file_name().unwrap().to_str().unwrap();
        name.replace(self.record.key(), "KEY")
    }
}

/// A record of a drum run: observables, a series, a picture as text, nulls.
fn realistic() -> Record {
    let wave = |i: u32| 38.0 + f64::from(i).sin();
    let series: Vec<f64> = (0..60).map(wave).collect();
    let picture: String = (0..600u32)
        .map(|i| char::from(b'A' + (i * i % 26) as u8))
        .collect();
    let repose = Observation {
        mean: 41.2,
        sd: None,
        n: 1,
        unit: "1".into(),
    };
    record(1)
        .with_observable("repose", repose)
        .unwrap()
        .with_regime(Some("rolling".into()))
        .with_details(json!({
            "steady": true, "start_up_s": null, "froude_number": 0.0, "last_frame_png_base64": picture,
            "series": {"time_s": series, "centre_of_mass_deg": [1, 2, -0.0, 1e-300]},
            "timing": {"steps": 123_456_789, "wall_s": 8.75},
        }))
}

/// A cheap generator of numbers below `n` (an odd multiplier, high bits): the damage need not be more random.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(0x5851_F42D_4C95_7F2D).wrapping_add(1);
        ((self.0 >> 33) % n as u64) as usize
    }

    fn digit(&mut self) -> u8 {
        b"0123456789"[self.below(10)]
    }
}

/// Damages as disks, transfers and fingers do: a flipped bit, another byte, a cut, inserted bytes, a block of zeros, a
/// block in another place, two bytes in each other's place.
fn damage(bytes: &[u8], numbers: &mut Numbers) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    let at = numbers.below(bytes.len());
    let end = (at + 1 + numbers.below(64)).min(bytes.len());
    match numbers.below(8) {
        0 => bytes[at] ^= 1 << numbers.below(8),
        1 => bytes[at] = numbers.digit(),
        2 => bytes.truncate(at),
        3 => bytes.insert(at, numbers.digit()),
        4 => bytes[at..end].fill(0),
        5 => drop(bytes.drain(at..end)),
        6 => {
            let other = numbers.below(bytes.len());
            bytes.swap(at, other);
        }
        _ => {
            let block = bytes[at..end].to_vec();
            let to = numbers.below(bytes.len());
            bytes.splice(to..to, block);
        }
    }
    bytes
}

/// Of 10 000 damages none is believed: the store finds the very record (the damage was white space, or did not change
/// a number to its last bit) or says that the file is damaged.
#[test]
fn no_damage_is_believed() {
    let kept = Kept::new(realistic());
    let whole = fs::read(&kept.file).unwrap();
    let content = serde_json::to_string(&kept.record).unwrap();
    let (mut numbers, mut found, mut harmless) = (Numbers(7), 0, 0);
    for _ in 0..10_000 {
        let damaged = damage(&whole, &mut numbers);
        // A new file each time: some systems force one to the disk that is cut and written again.
        fs::remove_file(&kept.file).unwrap();
        fs::write(&kept.file, &damaged).unwrap();
        match kept.store.get(kept.record.key()).unwrap() {
            Lookup::Found(read) => {
                let same = serde_json::to_string(&read).unwrap();
                assert_eq!(same, content, "{}", String::from_utf8_lossy(&damaged));
                harmless += 1;
            }
            Lookup::Damaged { .. } => found += 1,
            Lookup::Absent => panic!("the file is there"),
        }
    }
    assert!(
        found > 9000 && harmless > 10,
        "{found} found, {harmless} harmless"
    );
}

/// The same for what a state and a result are written as: of 10 000 damages each, the state is exact to the byte or not
/// believed, and the result has the same content or is not believed. A state of one run is none of another.
#[test]
fn no_damage_of_a_state_or_a_result_is_believed() {
    let content = serde_json::to_value(realistic()).unwrap();
    let json = serde_json::to_vec(&content).unwrap();
    let (state, result) = (seal_text("run", &json), seal(&content).unwrap());
    assert_eq!(unseal_text("run", &state), Ok(&json[..]));
    assert_eq!(unseal(&result).unwrap(), content);
    assert!(unseal_text("another", &state).is_err());
    let (mut numbers, mut states, mut results) = (Numbers(3), 0, 0);
    for _ in 0..10_000 {
        let damaged = damage(&state, &mut numbers);
        match unseal_text("run", &damaged) {
            Ok(read) => assert_eq!((read, &damaged), (&json[..], &state)),
            Err(_) => states += 1,
        }
        match unseal(&damage(&result, &mut numbers)) {
            Ok(read) => assert_eq!(read.to_string(), content.to_string()),
            Err(_) => results += 1,
        }
    }
    assert!(states > 9000 && results > 9000, "{states} {results}");
}

/// Fields that depend on the clock change no digest and may be altered; all else counts, the list of these fields too.
#[test]
fn a_digest_leaves_out_the_fields_that_it_names() {
    let content = |runs: u32, wall_s: f64| json!({"cost": {"runs": runs, "wall_s": wall_s}});
    let clock = ["/cost/wall_s", "/none/there"];
    let sealed = |runs, wall_s| seal_without(&content(runs, wall_s), &clock).unwrap();
    let text = String::from_utf8(sealed(3, 1.5)).unwrap();
    assert_eq!(unseal(text.as_bytes()).unwrap(), content(3, 1.5));
    let digest = |bytes: Vec<u8>| {
        serde_json::from_slice::<serde_json::Value>(&bytes).unwrap()["digest"].clone()
    };
    assert_eq!(digest(sealed(3, 1.5)), digest(sealed(3, 2.5)));
    assert_ne!(digest(sealed(3, 1.5)), digest(sealed(4, 1.5)));
    let later = text.replace("1.5", "2.5");
    assert_eq!(unseal(later.as_bytes()).unwrap(), content(3, 2.5));
    for altered in [
        text.replace(": 3", ": 4"),
        text.replace("/cost/wall_s", "/cost"),
        text.replace("not_in_digest", "other"),
    ] {
        assert!(unseal(altered.as_bytes()).is_err(), "{altered}");
    }
}

/// Every digit of a record counts: each is changed to the next one, and the file is not believed. Only in the last digit
/// of seventeen may the next one stand for the same number to its last bit; the record has four numbers of seventeen.
#[test]
fn one_changed_digit_anywhere_is_found() {
    let kept = Kept::new(record(1));
    let whole = fs::read(&kept.file).unwrap();
    let content = serde_json::to_string(&kept.record).unwrap();
    let digits = (0..whole.len()).filter(|i| whole[*i].is_ascii_digit());
    let mut believed = 0;
    for i in digits {
        let mut changed = whole.clone();
        changed[i] = b'0' + (changed[i] - b'0' + 1) % 10;
        fs::remove_file(&kept.file).unwrap();
        fs::write(&kept.file, &changed).unwrap();
        if let Lookup::Found(read) = kept.store.get(kept.record.key()).unwrap() {
            assert_eq!(serde_json::to_string(&read).unwrap(), content);
            believed += 1;
        }
    }
    assert!(believed <= 4, "{believed} digits do not count");
}

/// The reason tells a half written, an altered, a renamed and a record of another schema apart.
#[test]
fn what_is_wrong_with_a_file_is_told() {
    let kept = Kept::new(record(1));
    kept.edit(|text| text.replace("14.999999999999998", "15.0"));
    assert!(kept.reason().contains("altered"), "{}", kept.reason());
    kept.edit(|text| text[..text.len() / 2].to_owned());
    assert!(kept.reason().contains("EOF"), "{}", kept.reason());
    fs::write(&kept.file, "{\"schema\": 2, \"x\": 1}").unwrap();
    assert_eq!(
        kept.reason(),
        format!("it has schema 2, this program reads {SCHEMA}")
    );
    fs::write(&kept.file, format!("{{\"schema\": {SCHEMA}, \"x\": 1}}")).unwrap();
    assert!(kept.reason().contains("no digest"), "{}", kept.reason());
    let other = record(2);
    kept.store.put(&other).unwrap();
    fs::rename(
        kept.folder.path().join(format!("{}.json", other.key())),
        &kept.file,
    )
    .unwrap();
    assert!(kept.reason().contains(other.key()), "{}", kept.reason());
    fs::remove_file(&kept.file).unwrap();
    fs::create_dir(&kept.file).unwrap();
    assert_eq!(kept.reason(), "it is not a file");
}

/// A digest that fits the content is not enough: the content must be the run of the key.
#[test]
fn a_record_whose_key_was_altered_with_its_digest_is_not_believed() {
    let kept = Kept::new(record(1));
    let other = record(2);
    let altered = fs::read_to_string(&kept.file)
        .unwrap()
        .replace(kept.record.key(), other.key());
    fs::write(&kept.file, altered).unwrap();
    // The reason tells the digest that the content has; who forges it takes it from there.
    let reason = kept.reason();
    let digest = reason
        .split_whitespace()
        .find(|word| word.len() == 65)
        .unwrap();
    kept.edit(|text| {
        let states = text.split('"').nth(3).unwrap().to_owned();
        text.replace(&states, digest.trim_end_matches(','))
    });
    assert!(kept.reason().contains("renamed"), "{}", kept.reason());
}

/// A file that is set aside keeps its bytes, is not read as a record, and overwrites none that was set aside before.
#[test]
fn a_damaged_file_is_set_aside_and_kept() {
    let kept = Kept::new(record(1));
    for name in [
        "KEY.json.damaged",
        "KEY.json.damaged-2",
        "KEY.json.damaged-3",
    ] {
        fs::write(&kept.file, name).unwrap();
        assert_eq!(kept.set_aside(), name);
        assert_eq!(
            kept.store.get(kept.record.key()).unwrap(),
            Lookup::Absent,
            "{name}"
        );
        assert!(kept.store.keys().unwrap().is_empty(), "{name}");
    }
    let first = kept.file.with_extension("json.damaged");
    assert_eq!(fs::read_to_string(first).unwrap(), "KEY.json.damaged");
    fs::create_dir(&kept.file).unwrap();
    assert_eq!(kept.set_aside(), "KEY.json.damaged-4");
    assert_eq!(
        kept.store.set_aside(&kept.file).unwrap(),
        None,
        "nothing is left"
    );
    kept.store.put(&kept.record).unwrap();
    assert_eq!(
        kept.store.set_aside(&kept.file).unwrap(),
        None,
        "a record that another has written meanwhile stays"
    );
    assert_eq!(kept.store.keys().unwrap(), [kept.record.key()]);
    assert_eq!(fs::read_dir(kept.folder.path()).unwrap().count(), 5);
    let foreign = kept.folder.path().join("notes.txt");
    fs::write(&foreign, "mine").unwrap();
    assert!(kept.store.set_aside(&foreign).is_err(), "no record's name");
}

/// A link under the name of a record is renamed, and a link under an older name is not written through.
#[cfg(unix)]
#[test]
fn links_are_not_followed() {
    use std::os::unix::fs::symlink;
    let kept = Kept::new(record(1));
    let precious = kept.folder.path().join(".precious");
    fs::write(&precious, "mine").unwrap();
    fs::remove_file(&kept.file).unwrap();
    symlink(&precious, &kept.file).unwrap();
    symlink(&precious, kept.file.with_extension("json.damaged")).unwrap();
    let aside = format!(".{}.node-7.4711.0.aside", kept.record.key());
    let aside = kept.folder.path().join(aside);
    symlink(&precious, &aside).unwrap();
    assert!(!kept.reason().is_empty());
    assert_eq!(kept.set_aside(), "KEY.json.damaged-2");
    symlink(&precious, &kept.file).unwrap();
    kept.store.put(&kept.record).unwrap();
    Store::open(kept.folder.path()).unwrap();
    assert!(aside.is_symlink(), "not swept");
    assert_eq!(fs::read_to_string(&precious).unwrap(), "mine");
    assert!(!kept.file.is_symlink(), "the record replaces the link");
    symlink("nowhere", kept.file.with_extension("lost")).unwrap();
    fs::rename(kept.file.with_extension("lost"), &kept.file).unwrap();
    assert!(!kept.reason().is_empty(), "a link that leads nowhere");
}
