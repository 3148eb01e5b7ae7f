//! Flags of the commands that do runs, and the ends that they lead to.

use crate::stop::Stop;
use command_line::NOT_MET;
use scene::USUAL_RETRIES;
use std::io::Write as _;
use std::time::Duration;

/// How often a run is tried again.
#[derive(clap::Args, Debug, Clone, Copy)]
pub(crate) struct Retries {
    /// How often a run that diverges is tried again, each time with half the time step; its record says so
    #[arg(long = "retries", value_name = "N", default_value_t = USUAL_RETRIES,
        value_parser = clap::value_parser!(u32).range(..=6))]
    pub(crate) number: u32,
}

/// How long a process waits for others.
#[derive(clap::Args, Debug, Clone, Copy)]
pub(crate) struct Wait {
    /// Longest time without a run to do while other processes in the same folder do the rest; the process then ends with
    /// exit code 1, and the others continue [default: wait for their end]
    #[arg(long = "wait", value_name = "MINUTES", value_parser = clap::value_parser!(u32).range(2..))]
    minutes: Option<u32>,
}

impl Wait {
    /// The limit.
    pub(crate) fn limit(self) -> Option<Duration> {
        self.minutes
            .map(|minutes| Duration::from_mins(minutes.into()))
    }
}

/// The result of runs, or the exit code if a signal or `--wait` ended the process before its end, which it says.
///
/// # Errors
/// Any other error of the runs.
pub(crate) fn finished<T>(
    stop: &Stop,
    result: Result<T, study::Error>,
) -> anyhow::Result<Result<T, u8>> {
    match stop.result(result) {
        Err(error) if error.has_waited() => {
            // A closed standard error does not make the run fail.
            let _ = writeln!(std::io::stderr(), "{error}");
            Ok(Err(NOT_MET))
        }
        result => Ok(result?),
    }
}

#[cfg(test)]
mod tests {
    use super::finished;
    use crate::stop::Stop;
    use campaign::Error::Waited;
    use command_line::NOT_MET;

    /// A process that has waited long enough ends with 1: it has no result, and nothing is wrong.
    #[test]
    fn the_end_of_a_wait_is_no_error() {
        let stop = Stop::new(String::new).unwrap();
        let waited = || Waited {
            n_left: 1,
            n_runs: 2,
        };
        for error in [
            study::Error::Campaign(waited()),
            inference::Error::Campaign(waited()).into(),
        ] {
            assert_eq!(finished::<()>(&stop, Err(error)).unwrap(), Err(NOT_MET));
        }
    }
}
