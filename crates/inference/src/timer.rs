//! What each stage costs, and what is ahead.

use crate::diagnosis_stage::length_of;
use crate::samples::Runner;
use crate::{PlannedStage, RunList, StageCost};
use campaign::run_store::{Observation, Record};
use campaign::{Cores, PreparedRun, RunOutcome, RunRequest, Simulator, SimulatorError};
use serde_json::Value;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// Measures what each stage costs, and reports what is ahead.
pub(crate) struct Timer<'a> {
    /// Who hears of a stage.
    announce: &'a dyn Fn(&str),
    runner: &'a Runner<'a>,
    counted: &'a Counted<'a>,
    planned: &'a [PlannedStage],
    /// Length of the lists of each stage, at least and at most.
    lengths: Vec<[f64; 2]>,
    /// Begin of each stage so far: its name, the time, the runs before it.
    stages: Vec<(String, Instant, usize)>,
}

impl<'a> Timer<'a> {
    /// Starts without a stage.
    pub(crate) fn new(
        announce: &'a dyn Fn(&str),
        (runner, counted): (&'a Runner<'a>, &'a Counted<'a>),
        planned: &'a [PlannedStage],
    ) -> Self {
        let mut timer = Self {
            announce,
            runner,
            counted,
            planned,
            lengths: vec![[0.0; 2]; planned.len()],
            stages: Vec::new(),
        };
        for (i, stage) in planned.iter().enumerate() {
            timer.expect(i, stage);
        }
        timer
    }

    pub(crate) fn expect(&mut self, place: usize, stage: &PlannedStage) {
        let length =
            |lists: &[RunList]| length_of(&self.runner.campaign, self.runner.simulator, lists);
        let least = length(&stage.certain);
        self.lengths[place] = [least, least + length(&stage.further)];
    }

    /// Whether the plan has a stage at a place.
    pub(crate) fn has(&self, place: usize) -> bool {
        place < self.planned.len()
    }

    /// Begins a stage; the one before is over.
    pub(crate) fn begin(&mut self, place: usize) {
        let name = &self.planned[place].stage;
        (self.announce)(name);
        let later = self.lengths[place + 1..].iter();
        let later = later.fold([0.0; 2], |sum, length| {
            [0, 1].map(|end| sum[end] + length[end])
        });
        self.runner.campaign.expect(self.lengths[place], later);
        let begin = (name.clone(), Instant::now(), self.counted.runs());
        self.stages.push(begin);
    }

    pub(crate) fn end(mut self) -> Vec<StageCost> {
        let end = (String::new(), Instant::now(), self.counted.runs());
        self.stages.push(end);
        let pairs = self.stages.windows(2);
        pairs
            .map(|pair| StageCost {
                stage: pair[0].0.clone(),
                runs: pair[1].2 - pair[0].2,
                wall_s: (pair[1].1 - pair[0].1).as_secs_f64(),
            })
            .collect()
    }
}

/// A simulator that counts its runs.
pub(crate) struct Counted<'a> {
    simulator: &'a dyn Simulator,
    /// Runs so far.
    count: AtomicUsize,
}

impl<'a> Counted<'a> {
    pub(crate) fn new(simulator: &'a dyn Simulator) -> Self {
        Self {
            simulator,
            count: AtomicUsize::new(0),
        }
    }

    pub(crate) fn runs(&self) -> usize {
        self.count.load(Ordering::Relaxed)
    }
}

impl Simulator for Counted<'_> {
    fn version(&self) -> String {
        self.simulator.version()
    }

    fn run(&self, request: &RunRequest) -> Result<RunOutcome, SimulatorError> {
        self.count.fetch_add(1, Ordering::Relaxed);
        self.simulator.run(request)
    }

    fn prepare<'s>(
        &'s self,
        request: &RunRequest,
    ) -> Result<Box<dyn PreparedRun + 's>, SimulatorError> {
        let prepared = self.simulator.prepare(request)?;
        let count = &self.count;
        Ok(Box::new(CountedRun { prepared, count }))
    }

    fn read_further(
        &self,
        request: &RunRequest,
        record: &Record,
    ) -> Result<BTreeMap<String, Observation>, SimulatorError> {
        self.simulator.read_further(request, record)
    }
}

/// A run that is counted when it is done.
struct CountedRun<'a> {
    prepared: Box<dyn PreparedRun + 'a>,
    count: &'a AtomicUsize,
}

impl PreparedRun for CountedRun<'_> {
    fn inputs(&self) -> Result<Value, SimulatorError> {
        self.prepared.inputs()
    }

    fn cost(&self) -> f64 {
        self.prepared.cost()
    }

    fn run(&self, cores: &Cores) -> Result<RunOutcome, SimulatorError> {
        self.count.fetch_add(1, Ordering::Relaxed);
        self.prepared.run(cores)
    }
}
