//! Names of the scenes, and how many steps make a block.

use std::fmt;
use std::str::FromStr;

/// Seeds in the drum of the study.
pub(crate) const SEEDS_OF_STUDY: usize = 1200;
/// Plain spheres in a drum of the study's size, about a third of its volume.
pub(crate) const SPHERES_OF_TILE: usize = 2000;
/// Fewest steps of a block: several renewals of the neighbour lists.
const FEWEST_STEPS: usize = 200;

/// A scene that can be measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum BenchmarkScene {
    /// Seeds in a drum.
    Seeds(usize),
    /// Plain spheres in a drum.
    Spheres(usize),
}

impl BenchmarkScene {
    /// Steps of a block: some tenths of a second for small scenes.
    pub(crate) fn block_steps(self) -> usize {
        match self {
            Self::Seeds(count) => (900_000 / count).max(FEWEST_STEPS),
            Self::Spheres(count) => (4_000_000 / count).max(FEWEST_STEPS),
        }
    }
}

impl fmt::Display for BenchmarkScene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Seeds(count) => write!(f, "seeds-{count}"),
            Self::Spheres(count) => write!(f, "spheres-{count}"),
        }
    }
}

impl FromStr for BenchmarkScene {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (kind, count) = text.split_once('-').unwrap_or((text, ""));
        let count = count.parse().unwrap_or(0);
        let sizes = match kind {
            "seeds" if count > SEEDS_OF_STUDY => SEEDS_OF_STUDY..=120_000,
            "seeds" => 300..=SEEDS_OF_STUDY,
            "spheres" => SPHERES_OF_TILE..=10_000_000,
            _ => return Err("expected seeds-N or spheres-N, such as seeds-1200".into()),
        };
        // A longer drum repeats the flowing bed of a short one.
        let whole = count <= *sizes.start() || count % sizes.start() == 0;
        let short = kind == "seeds" && count <= SEEDS_OF_STUDY;
        if !sizes.contains(&count) || !(whole || short) {
            let step = if short { "" } else { " and a multiple of it" };
            return Err(format!(
                "the number of {kind} must be from {}{step} to {}",
                sizes.start(),
                sizes.end()
            ));
        }
        Ok(if kind == "seeds" {
            Self::Seeds(count)
        } else {
            Self::Spheres(count)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::BenchmarkScene;

    #[test]
    fn a_name_reads_back_as_its_scene_and_a_wrong_one_is_refused() {
        for name in ["seeds-300", "seeds-1000", "seeds-4800", "spheres-10000"] {
            let scene: BenchmarkScene = name.parse().unwrap();
            assert_eq!(scene.to_string(), name);
        }
        for name in [
            "seeds",
            "seeds-0",
            "seeds-1300",
            "spheres-2500",
            "cubes-300",
            "spheres--1",
        ] {
            assert!(name.parse::<BenchmarkScene>().is_err(), "{name}");
        }
    }
}
