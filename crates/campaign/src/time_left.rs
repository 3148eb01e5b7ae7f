//! Time to the end of a campaign.

/// Data of the estimate; costs in the simulator's relative unit.
#[derive(Debug, Clone, Default)]
pub(crate) struct Workload {
    /// Measured time of the finished runs of the loop over their cost, s; `None` before one is finished.
    pub(crate) pace_s: Option<f64>,
    /// Running ones: cost.
    pub(crate) cost_running: Vec<f64>,
    /// Running ones: time since their start, s; same order.
    pub(crate) time_running_s: Vec<f64>,
    /// Costs of the runs still waiting, in the order in which they will start.
    pub(crate) cost_waiting: Vec<f64>,
    /// Expected length of all later lists, in costs of runs behind each other: at least and at most.
    pub(crate) ahead: [f64; 2],
    /// Number of workers.
    pub(crate) workers: usize,
}

impl Workload {
    /// Estimates the time to the end of the loop, s, at least and at most: of this list, and of the lists ahead of it.
    ///
    /// # Formula
    ///
    /// (end of this list) + (length of the lists ahead) * (seconds per cost). `None` while there is work but no finished run to
    /// measure.
    pub(crate) fn time_left_s(&self) -> Option<[f64; 2]> {
        let list = self.list_left_s()?;
        if self.ahead == [0.0; 2] {
            return Some([list; 2]);
        }
        let pace = self.pace_s?;
        Some(self.ahead.map(|ahead| list + ahead * pace))
    }

    /// Estimates the time to the end of the last run of this list, s.
    ///
    /// # Formula
    ///
    /// Seconds per cost = (sum of measured times) / (sum of their costs). With it every running
    /// run still needs max(0, expected - elapsed), and each waiting one starts on the worker that
    /// is free first; the answer is the end of the last one. `None` while there is work
    /// but no finished run to measure.
    pub(crate) fn list_left_s(&self) -> Option<f64> {
        if self.cost_running.is_empty() && self.cost_waiting.is_empty() {
            return Some(0.0);
        }
        let pace = self.pace_s?;
        let mut free_at: Vec<f64> = self
            .cost_running
            .iter()
            .zip(&self.time_running_s)
            .map(|(cost, elapsed)| (cost * pace - elapsed).max(0.0))
            .collect();
        free_at.resize(self.workers.max(free_at.len()).max(1), 0.0);
        let waiting = self.cost_waiting.iter().map(|cost| cost * pace);
        Some(end_of_last(free_at, waiting))
    }
}

/// When the last run of a list ends whose runs begin in their order, each on the worker that is free first; workers by the time at
/// which they are free, in the unit of the runs.
pub(crate) fn end_of_last(mut free_at: Vec<f64>, runs: impl Iterator<Item = f64>) -> f64 {
    for run in runs {
        if let Some(first) = free_at.iter_mut().min_by(|a, b| a.total_cmp(b)) {
            *first += run;
        }
    }
    free_at.into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::Workload;

    fn workload() -> Workload {
        Workload {
            pace_s: Some(2.0),
            cost_running: vec![3.0, 1.0],
            time_running_s: vec![1.0, 5.0],
            cost_waiting: vec![2.0, 1.0, 1.0],
            ahead: [0.0; 2],
            workers: 2,
        }
    }

    /// By hand: 2 s per cost; running need 5 s and 0 s; then 4 s on the second, 2 s on the second
    /// (4 < 5), 2 s on the first: ends at 7 s and 6 s.
    #[test]
    fn time_left_is_the_end_of_the_last_run_of_the_list_schedule() {
        assert_eq!(workload().time_left_s(), Some([7.0; 2]));
    }

    #[test]
    fn time_left_is_unknown_before_anything_was_measured_and_zero_when_nothing_is_left() {
        let unmeasured = Workload {
            pace_s: None,
            ..workload()
        };
        assert_eq!(unmeasured.time_left_s(), None);
        assert_eq!(Workload::default().time_left_s(), Some([0.0; 2]));
    }

    /// By hand: this list ends in 7 s; lists of the length 3 to 5 take 6 to 10 s. What lies ahead counts when this list is done
    /// too, and it is unknown before a run was measured.
    #[test]
    fn time_left_holds_what_later_lists_will_ask_for() {
        let with_later = Workload {
            ahead: [3.0, 5.0],
            ..workload()
        };
        assert_eq!(with_later.list_left_s(), Some(7.0));
        assert_eq!(with_later.time_left_s(), Some([13.0, 17.0]));
        let list_done = Workload {
            cost_running: Vec::new(),
            cost_waiting: Vec::new(),
            ..with_later.clone()
        };
        assert_eq!(list_done.time_left_s(), Some([6.0, 10.0]));
        let unmeasured = Workload {
            pace_s: None,
            ..list_done
        };
        assert_eq!(unmeasured.time_left_s(), None);
    }

    /// One long run at the end cannot be shared between workers.
    #[test]
    fn more_workers_than_runs_do_not_shorten_the_longest() {
        let tail = Workload {
            cost_running: Vec::new(),
            time_running_s: Vec::new(),
            cost_waiting: vec![10.0],
            workers: 8,
            ..workload()
        };
        assert_eq!(tail.time_left_s(), Some([20.0; 2]));
    }
}
