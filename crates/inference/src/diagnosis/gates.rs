//! The two gates that a residual must pass before any effect is named.

use nalgebra::DVector;
use probability::random_stream::Stream;

use crate::diagnosis::Options;
use crate::diagnosis::fit::{Fit, Score, SmoothTest};
use crate::diagnosis::max_test::MaxTest;
use crate::diagnosis::problem::Problem;

/// Family-wise chance of a false alarm; doubling it lowers the smallest detectable amplitude by
/// about 8 %.
pub(crate) const ALPHA: f64 = 0.05;
/// Level of each of the two gates, and of each adequacy check.
pub(crate) const GATE: f64 = ALPHA / 2.0;
/// Level of the adequacy check inside the smooth basis. With that of the whole residual it may cost 3 % of the right
/// names. It is the narrower of the two, because the Bayes factor over an unknown smooth effect guards the same ground.
const SMOOTH_ADEQUACY: f64 = 0.005;

/// What the gates say of a fit.
#[derive(Debug, Clone)]
pub(crate) struct Gates {
    /// Upper tail of the structured residual.
    pub(crate) p: Option<f64>,
    /// The same inside the smooth basis.
    pub(crate) smooth: SmoothTest,
    /// How each candidate that is off would help (effects of the library); `None` if absorbed.
    pub(crate) scores: Vec<Option<Score>>,
    /// Candidates that take part in the directed gate.
    pub(crate) family: Vec<usize>,
    /// Null distribution of their largest statistic.
    pub(crate) max_test: MaxTest,
    /// The candidate that takes most off the residual with a physically possible amplitude.
    pub(crate) best: Option<usize>,
    /// Its chance under the null hypothesis; 1 without candidates.
    pub(crate) p_best: f64,
}

impl Gates {
    /// Puts a fit to the gates; `testable` are the candidates that may take part.
    pub(crate) fn new(problem: &Problem, fit: &Fit, testable: &[usize], options: &Options) -> Self {
        let scores: Vec<Option<Score>> = (0..problem.candidates.len())
            .map(|j| {
                let off = !fit.effects.contains(&j);
                off.then(|| fit.score(j, &problem.candidates[j]))?
            })
            .collect();
        let family: Vec<usize> = testable
            .iter()
            .copied()
            .filter(|&j| scores[j].is_some())
            .collect();
        let directions: Vec<&DVector<f64>> = family
            .iter()
            .filter_map(|&j| scores[j].as_ref().map(|s| &s.direction))
            .collect();
        let signs: Vec<_> = family.iter().map(|&j| problem.candidates[j].sign).collect();
        let mut stream = Stream::new(options.seed, "largest score");
        let draws = if family.is_empty() { 0 } else { options.draws };
        let dof = problem.covariance_dof;
        let outward = fit.outward();
        let max_test = MaxTest::simulate(&directions, &signs, &outward, dof, draws, &mut stream);
        let mut gates = Self {
            p: fit.p(problem),
            smooth: fit.smooth_test(problem),
            scores,
            family,
            max_test,
            best: None,
            p_best: 1.0,
        };
        let possible = |j: &usize| {
            let candidate = &problem.candidates[*j];
            let score = gates.scores[*j].as_ref();
            score.map_or(0.0, |s| candidate.sign.statistic(s.gain))
        };
        gates.best = gates
            .family
            .iter()
            .copied()
            .max_by(|a, b| possible(a).total_cmp(&possible(b)));
        if let Some(j) = gates.best {
            gates.p_best = gates.max_test.p(gates.statistic(problem, j));
        }
        gates
    }

    /// The test statistic of a candidate.
    pub(crate) fn statistic(&self, problem: &Problem, effect: usize) -> f64 {
        self.scores[effect]
            .as_ref()
            .map_or(0.0, |s| problem.candidates[effect].sign.statistic(s.z))
    }

    /// Whether there is structure at all, at half the level for each of its two forms.
    pub(crate) fn omnibus(&self) -> bool {
        let below = |p: Option<f64>, level| p.is_some_and(|p| p <= level);
        match self.smooth.p {
            Some(_) => below(self.p, GATE / 2.0) || below(self.smooth.p, GATE / 2.0),
            None => below(self.p, GATE),
        }
    }

    /// Whether a candidate of the library stands out.
    pub(crate) fn directed(&self) -> bool {
        self.best.is_some() && self.p_best <= GATE
    }

    /// Whether what remains is no more than noise, as a whole and inside the smooth basis.
    pub(crate) fn adequate(&self) -> bool {
        self.p.is_none_or(|p| p > GATE) && self.smooth.p.is_none_or(|p| p > SMOOTH_ADEQUACY)
    }
}
