//! How long the rest of a campaign will take.

/// What the estimate rests on; costs in the simulator's relative unit.
#[derive(Debug, Clone, Default)]
pub(crate) struct Workload {
    /// Costs of the runs that were finished in this campaign, summed.
    pub(crate) cost_finished: f64,
    /// Time that those took, summed over the runs, s.
    pub(crate) time_finished_s: f64,
    /// Running ones: cost.
    pub(crate) cost_running: Vec<f64>,
    /// Running ones: time since their start, s; same order.
    pub(crate) time_running_s: Vec<f64>,
    /// Costs of the runs still waiting, in the order in which they will start.
    pub(crate) cost_waiting: Vec<f64>,
    /// Number of workers.
    pub(crate) workers: usize,
}

impl Workload {
    /// Measured time of a run over its cost, s; none before a run is finished.
    pub(crate) fn pace(&self) -> Option<f64> {
        (self.cost_finished > 0.0).then(|| self.time_finished_s / self.cost_finished)
    }

    /// Estimates the time to the end of the last run, s.
    ///
    /// # Formula
    ///
    /// Seconds per cost = (sum of measured times) / (sum of their costs). With it every running
    /// run still needs max(0, expected - elapsed), and each waiting one starts on the worker that
    /// is free first, as it will; the answer is the end of the last one. None while there is work
    /// but no finished run to measure.
    pub(crate) fn time_left_s(&self) -> Option<f64> {
        if self.cost_running.is_empty() && self.cost_waiting.is_empty() {
            return Some(0.0);
        }
        let pace = self.pace()?;
        let mut free_at: Vec<f64> = self
            .cost_running
            .iter()
            .zip(&self.time_running_s)
            .map(|(cost, elapsed)| (cost * pace - elapsed).max(0.0))
            .collect();
        free_at.resize(self.workers.max(free_at.len()).max(1), 0.0);
        for cost in &self.cost_waiting {
            if let Some(first) = free_at.iter_mut().min_by(|a, b| a.total_cmp(b)) {
                *first += cost * pace;
            }
        }
        free_at.into_iter().reduce(f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::Workload;

    fn workload() -> Workload {
        Workload {
            cost_finished: 4.0,
            time_finished_s: 8.0,
            cost_running: vec![3.0, 1.0],
            time_running_s: vec![1.0, 5.0],
            cost_waiting: vec![2.0, 1.0, 1.0],
            workers: 2,
        }
    }

    /// By hand: 2 s per cost; running need 5 s and 0 s; then 4 s on the second, 2 s on the second
    /// (4 < 5), 2 s on the first: ends at 7 s and 6 s.
    #[test]
    fn time_left_is_the_end_of_the_last_run_of_the_list_schedule() {
        assert_eq!(workload().time_left_s(), Some(7.0));
    }

    #[test]
    fn time_left_is_unknown_before_anything_was_measured_and_zero_when_nothing_is_left() {
        let unmeasured = Workload {
            cost_finished: 0.0,
            time_finished_s: 0.0,
            ..workload()
        };
        assert_eq!(unmeasured.time_left_s(), None);
        assert_eq!(Workload::default().time_left_s(), Some(0.0));
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
        assert_eq!(tail.time_left_s(), Some(20.0));
    }
}
