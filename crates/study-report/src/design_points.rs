//! The points of a design with their runs.

use crate::numbers::digits;
use inference::ModelSurfaces;

/// A point and the runs made there.
#[derive(Debug)]
pub(crate) struct DesignPoint<'a> {
    /// Its number, from 0.
    pub(crate) number: usize,
    /// Natural values of the parameters of the model.
    pub(crate) settings: &'a [f64],
    /// Numbers of its runs among those of the surfaces, from 0.
    pub(crate) runs: Vec<usize>,
}

/// The points of the runs that entered surfaces, in the order of their first runs.
pub(crate) fn design_points(surfaces: &ModelSurfaces) -> Vec<DesignPoint<'_>> {
    let mut points: Vec<DesignPoint<'_>> = Vec::new();
    for (run, settings) in surfaces.points.iter().enumerate() {
        match points.iter_mut().find(|p| p.settings == settings) {
            Some(known) => known.runs.push(run),
            None => points.push(DesignPoint {
                number: points.len(),
                settings,
                runs: vec![run],
            }),
        }
    }
    points
}

impl DesignPoint<'_> {
    /// What the part of the page that shows it is called, by the number of its model in the list of surfaces.
    pub(crate) fn id(&self, model: usize) -> String {
        format!("run-{}-{}", model + 1, self.number + 1)
    }

    /// Its runs and settings in words.
    pub(crate) fn name(&self, symbols: &[String]) -> String {
        let numbers: Vec<String> = self.runs.iter().map(|k| (k + 1).to_string()).collect();
        let word = if numbers.len() == 1 { "Run" } else { "Runs" };
        let settings = symbols.iter().zip(self.settings);
        let settings: Vec<String> = settings
            .map(|(symbol, x)| format!("{symbol} = {}", digits(*x)))
            .collect();
        format!("{word} {}: {}", numbers.join(", "), settings.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::design_points;
    use crate::test_surfaces::surfaces;

    /// The face-centred design has three runs in its middle, and eight points with one each.
    #[test]
    fn runs_of_the_same_settings_are_one_point() {
        let surfaces = surfaces();
        let points = design_points(&surfaces[0]);
        assert_eq!(points.len(), 9);
        let middle = &points[8];
        assert_eq!(middle.runs, [8, 9, 10]);
        assert_eq!(middle.id(0), "run-1-9");
        assert_eq!(
            middle.name(&surfaces[0].symbols),
            "Runs 9, 10, 11: F = 0.350, E = 0.350"
        );
        assert!(points[..8].iter().all(|p| p.runs.len() == 1));
    }
}
