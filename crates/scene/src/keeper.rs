//! Who hears how far a run is, keeps its state and may end it.

use crate::motion::Progress;
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

/// How far a run is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunStage {
    /// Whether the drive runs, or the wall is on its way; the seeds settle before that.
    pub driven: bool,
    /// Time since the drive started, or since the seeds began to settle, s.
    pub time_s: f64,
    /// Most time that this may take, s.
    pub limit_s: f64,
    /// Frames that were taken, and frames that are wanted.
    pub frames: [usize; 2],
}

/// Where the state of a run is kept on its way.
///
/// It is asked after each interval of the series. What it costs to keep a state is some milliseconds
/// and megabytes, so that it should not keep every one.
pub trait Keeper {
    /// Whether a state is wanted now.
    fn is_due(&mut self) -> bool;

    /// Keeps a state.
    ///
    /// # Errors
    ///
    /// A state that cannot be kept, in words.
    fn keep(&mut self, progress: &Progress) -> Result<(), String>;

    /// Hears how far the run is.
    fn hear(&mut self, stage: &RunStage) {
        let _ = stage;
    }

    /// Most threads that the run may use from now on; `None`: as many as before.
    fn threads(&self) -> Option<usize> {
        None
    }

    /// Whether the run is to end here, with its state kept.
    fn is_stopped(&self) -> bool {
        false
    }

    /// Is called if an attempt has diverged and the run starts again with half the step. States kept before are void.
    ///
    /// # Errors
    ///
    /// States that cannot be given up, in words.
    fn begin_anew(&mut self, why: &str) -> Result<(), String> {
        let _ = why;
        Ok(())
    }
}

/// Keeps nothing.
#[derive(Debug, Clone, Copy)]
pub struct NoKeeper;

impl Keeper for NoKeeper {
    fn is_due(&mut self) -> bool {
        false
    }

    fn keep(&mut self, _: &Progress) -> Result<(), String> {
        Ok(())
    }
}

/// Keeps nothing, ends the run when a flag is raised, and gives the number of threads.
pub struct Control<'a> {
    /// Ends the run once it is true.
    pub stop: &'a AtomicBool,
    /// Most threads that the run may use at the time.
    pub threads: &'a dyn Fn() -> usize,
}

impl fmt::Debug for Control<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Control")
            .field("stop", self.stop)
            .finish_non_exhaustive()
    }
}

impl Keeper for Control<'_> {
    fn is_due(&mut self) -> bool {
        false
    }

    fn keep(&mut self, _: &Progress) -> Result<(), String> {
        Ok(())
    }

    fn threads(&self) -> Option<usize> {
        Some((self.threads)())
    }

    fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::SeqCst)
    }
}
