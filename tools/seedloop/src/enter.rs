//! Entering the folder of a campaign: reports another owner, and a machine that is too small.

use anyhow::{Context as _, bail};
use campaign::run_store::{ClaimKeeper, Entry, Store};
use command_line::Common;
use scene::Scene;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Takes the folder of a campaign for this process until the keeper is dropped. One who does the same work in it shares its
/// runs.
///
/// # Errors
/// A folder in which another process does other work, or that cannot be used.
pub(crate) fn enter(folder: &Path, work: &str, common: &Common) -> anyhow::Result<ClaimKeeper> {
    let store = Store::open(folder.join("runs"))?;
    match store.enter(work)? {
        Entry::Ours(keeper) => Ok(keeper),
        Entry::Shared(keeper, holder) => {
            common.log(|| {
                format!(
                    "{holder}, does the same in {}: the runs are shared",
                    folder.display()
                )
            });
            Ok(keeper)
        }
        Entry::Taken(holder) => bail!(
            "{} is in use by {holder}, with other input: wait for its end, or give another --out",
            folder.display()
        ),
    }
}

/// What a campaign works on: the same text of the same input.
pub(crate) fn work_of(
    what: &str,
    inputs: &BTreeMap<String, String>,
    further: &impl std::fmt::Debug,
) -> String {
    // Without the names, so that it does not depend on how a path was typed.
    let mut digests: Vec<&String> = inputs.values().collect();
    digests.sort();
    format!("{what} {digests:?} {further:?}")
}

/// Refuses runs that would take more memory than this machine has left; `at_a_time` runs are done side by side.
///
/// # Errors
/// The estimate, what there is, and the remedy.
pub(crate) fn require_memory<'s>(
    scenes: impl IntoIterator<Item = &'s Scene>,
    at_a_time: usize,
) -> anyhow::Result<()> {
    let largest = scenes.into_iter().map(Scene::estimated_memory);
    let needed = at_a_time as f64 * largest.fold(0.0, f64::max);
    let Some(left) = memory_left() else {
        return Ok(());
    };
    let gib = |bytes: f64| bytes / f64::from(1 << 30);
    if needed > left {
        bail!(
            "{at_a_time} runs at a time take about {:.1} GiB of memory, and {:.1} GiB are left: take fewer seeds or frames, \
             or fewer --threads",
            gib(needed),
            gib(left)
        );
    }
    Ok(())
}

/// Memory that this process may still take, B: the least of what the system has available and of the limit of the process.
/// `None` if the system does not say.
fn memory_left() -> Option<f64> {
    let system = fs::read_to_string("/proc/meminfo").ok()?;
    let limits = fs::read_to_string("/proc/self/limits").unwrap_or_default();
    let number = |text: &str, name: &str| -> Option<f64> {
        let line = text.lines().find_map(|line| line.strip_prefix(name))?;
        line.split_whitespace().next()?.parse().ok()
    };
    let available = 1024.0 * number(&system, "MemAvailable:")?;
    // The word "unlimited" is not a number.
    let limit = number(&limits, "Max address space").unwrap_or(f64::INFINITY);
    Some(available.min(limit))
}

/// The keeper of one run, so that no other process does it in the same folder at the same time.
///
/// # Errors
/// A run that another process does, a folder that cannot be used.
pub(crate) fn keep_run(store: &Store, key: &str) -> anyhow::Result<ClaimKeeper> {
    let place = store.folder().unwrap_or(Path::new("")).display();
    match store.keep_run(key).context("cannot claim the run")? {
        Entry::Ours(keeper) | Entry::Shared(keeper, _) => Ok(keeper),
        Entry::Taken(holder) => bail!(
            "{holder}, does this run in {place}: wait for its end and say --resume to take its record, or give another --out"
        ),
    }
}
