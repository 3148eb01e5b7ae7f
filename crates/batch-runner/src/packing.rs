//! Packing short runs into tasks.

use crate::BatchSettings;

/// How runs are packed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Packing {
    /// Time of a run of cost 1, s; unknown where absent.
    pub seconds_per_cost: Option<f64>,
    /// A task should last no longer than this, s.
    pub task_seconds: f64,
    /// Runs are not spread over tasks shorter than this, s.
    pub least_task_seconds: f64,
    /// Most tasks.
    pub most_tasks: usize,
    /// Tasks that may run at a time: the runs are spread over all of them.
    pub slots: Option<usize>,
    /// Runs of a task that go on at a time.
    pub threads: usize,
}

impl Packing {
    /// How the settings want runs to be packed; `measured` is what workers told of the time of a run of cost 1, s.
    pub(crate) fn new(settings: &BatchSettings, measured: Option<f64>) -> Self {
        // Expected times are rough: half of the time limit leaves room for a factor of two.
        let most_s = settings.time_limit_s.map(|limit| limit as f64 / 2.0);
        Self {
            seconds_per_cost: settings.seconds_per_cost.or(measured),
            task_seconds: most_s.map_or(settings.task_seconds, |s| s.min(settings.task_seconds)),
            least_task_seconds: settings.least_task_seconds,
            most_tasks: settings.most_tasks,
            slots: settings.array_limit,
            threads: settings.cpus_per_task,
        }
    }
}

/// Packs runs of these costs (positive) into tasks: each task is a list of places in `costs`, longest run first.
///
/// Longest runs first, each goes into the first task that has room for it (first fit decreasing); a run that is longer
/// than a task should be has a task alone. Where the tasks would be more than allowed, or where the time of a run is
/// not known, each run goes to the task that has the least to do so far, over as many tasks as may be.
pub fn pack(costs: &[f64], packing: &Packing) -> Vec<Vec<usize>> {
    let mut order: Vec<usize> = (0..costs.len()).collect();
    let cost = |i: &usize| costs.get(*i).copied().unwrap_or(1.0);
    // A stable sort: equal costs stay in the order in which they were given.
    order.sort_by(|a, b| cost(b).total_cmp(&cost(a)));
    let most = packing.most_tasks.max(1);
    let Some(pace) = packing.seconds_per_cost else {
        return spread(&order, &cost, most.min(order.len()));
    };
    // Each thread of a task has the time of a task.
    let threads = packing.threads.max(1) as f64;
    let total_s: f64 = order.iter().map(&cost).sum::<f64>() * pace / threads;
    let share_s = packing.slots.map(|slots| total_s / slots.max(1) as f64);
    let aim_s = share_s
        .map_or(packing.task_seconds, |s| s.max(packing.least_task_seconds))
        .min(packing.task_seconds);
    let mut tasks: Vec<(f64, Vec<usize>)> = Vec::new();
    for i in &order {
        let run_s = cost(i) * pace / threads;
        // Sums of rounded numbers: a task that is full to the last bit counts as having room.
        let room =
            |(filled_s, _): &&mut (f64, Vec<usize>)| filled_s + run_s <= aim_s * (1.0 + 1e-9);
        if let Some((filled_s, runs)) = tasks.iter_mut().find(room) {
            *filled_s += run_s;
            runs.push(*i);
        } else {
            tasks.push((run_s, vec![*i]));
        }
    }
    if tasks.len() > most {
        return spread(&order, &cost, most);
    }
    tasks.into_iter().map(|(_, runs)| runs).collect()
}

/// Gives each run in order to the task with the least to do.
fn spread(order: &[usize], cost: &dyn Fn(&usize) -> f64, tasks: usize) -> Vec<Vec<usize>> {
    let mut filled = vec![0.0; tasks];
    let mut lists = vec![Vec::new(); tasks];
    for i in order {
        let least = (0..tasks).min_by(|a, b| f64::total_cmp(&filled[*a], &filled[*b]));
        if let Some(least) = least {
            filled[least] += cost(i);
            lists[least].push(*i);
        }
    }
    lists
}

#[cfg(test)]
mod tests {
    use super::{Packing, pack};
    use proptest::prelude::*;

    /// Ten seconds a task, no other limit.
    const TEN_S: Packing = Packing {
        seconds_per_cost: Some(2.0),
        task_seconds: 10.0,
        least_task_seconds: 0.0,
        most_tasks: 1000,
        slots: None,
        threads: 1,
    };

    /// By hand: 2 s per cost; 6 (12 s) is alone; 4 + 1 fill a task, 3 + 2 another.
    #[test]
    fn longest_runs_come_first_and_short_ones_fill_up() {
        let tasks = pack(&[1.0, 6.0, 3.0, 4.0, 2.0], &TEN_S);
        assert_eq!(tasks, [vec![1], vec![3, 0], vec![2, 4]]);
    }

    /// Two threads do twice as much in the time of a task.
    #[test]
    fn threads_of_a_task_share_its_time() {
        let packing = Packing {
            threads: 2,
            ..TEN_S
        };
        assert_eq!(pack(&[5.0, 5.0, 5.0], &packing), [vec![0, 1], vec![2]]);
    }

    /// Without a known pace each run has a task of its own, as far as tasks are allowed.
    #[test]
    fn runs_of_unknown_time_are_spread() {
        let packing = Packing {
            seconds_per_cost: None,
            most_tasks: 2,
            ..TEN_S
        };
        assert_eq!(pack(&[1.0, 1.0, 1.0], &packing), [vec![0, 2], vec![1]]);
        assert_eq!(pack(&[1.0], &packing), [vec![0]]);
        assert!(pack(&[], &packing).is_empty());
    }

    /// 16 runs of 2 s on 8 slots: 4 s each, not all in tasks of 10 s; but not below the least time of a task.
    #[test]
    fn all_slots_get_work_unless_tasks_become_too_short() {
        let mut packing = Packing {
            slots: Some(8),
            ..TEN_S
        };
        assert_eq!(pack(&[1.0; 16], &packing).len(), 8);
        packing.least_task_seconds = 8.0;
        assert_eq!(pack(&[1.0; 16], &packing).len(), 4);
    }

    proptest! {
        /// Each run is in one task; no task is longer than the aim unless it is a single run; no more tasks than
        /// allowed, in which case the aim gives way.
        #[test]
        fn every_run_is_in_exactly_one_task_and_no_task_is_too_long(
            costs in proptest::collection::vec(0.01_f64..20.0, 0..60),
            most_tasks in 1_usize..80,
        ) {
            let packing = Packing { most_tasks, ..TEN_S };
            let tasks = pack(&costs, &packing);
            let mut seen: Vec<usize> = tasks.iter().flatten().copied().collect();
            seen.sort_unstable();
            prop_assert_eq!(seen, (0..costs.len()).collect::<Vec<_>>());
            prop_assert!(tasks.len() <= most_tasks);
            prop_assert!(tasks.iter().all(|task| !task.is_empty()));
            let time_s = |task: &Vec<usize>| 2.0 * task.iter().map(|i| costs[*i]).sum::<f64>();
            // First fit decreasing was used where it met the limit on tasks.
            let fits = pack(&costs, &TEN_S).len() <= most_tasks;
            if fits {
                // Rounding of at most 60 sums.
                let late = tasks.iter().find(|t| t.len() > 1 && time_s(t) > 10.0 * (1.0 + 1e-8));
                prop_assert!(late.is_none(), "{:?}", late);
            }
        }
    }
}
