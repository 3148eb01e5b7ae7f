//! `[coarse_graining]`: what it gives.

use super::folder::{Folder, STUDY};
use campaign::Simulator as _;
use study::Study;

/// The study of peas with a table, and without effects.
fn peas(table: &str) -> String {
    format!("{STUDY}\n[effects]\nsearch = []\n[coarse_graining]\n{table}\n")
}

/// Both conditions of the drum have coarse grains and the sled does not; sizes are distinguished from the coarsest on. Runs with coarser grains cost
/// less: 100 peas of 6 mm are 42 of 8 mm.
#[test]
fn scenes_have_coarser_grains_in_their_runs() {
    let folder = Folder::new(&peas("scenes = [\"drum\"]\nfactors = [1.33, 1.6]"));
    let study: Study = folder.read(None).unwrap();
    let coarse = study.problem.coarse_graining.as_ref().unwrap();
    assert_eq!(
        (&coarse.models[..], &coarse.factors[..]),
        (&[0, 1][..], &[1.6, 1.33][..])
    );
    assert_eq!(coarse.error, 1.0);
    assert!(
        study
            .defaults
            .iter()
            .any(|d| d.key == "coarse_graining: error")
    );
    let price = study::plan_study(&study, 1, &folder.path("out")).unwrap();
    let factors: Vec<f64> = price.sizes.iter().map(|size| size.factor).collect();
    assert_eq!(factors, [1.33, 1.6]);
    assert!(
        price.sizes[1].core_s < price.sizes[0].core_s,
        "{:?}",
        price.sizes
    );
    assert!(
        price.sizes[0].core_s < price.sizes[0].real_core_s,
        "{:?}",
        price.sizes
    );
    let simulator = study.simulator(&folder.path("out")).unwrap();
    let request = campaign::RunRequest::new(&study.problem.models[0].name, 1);
    let request = request.with_parameter(inference::CoarseGraining::SYMBOL, 1.33);
    assert!(simulator.prepare(&request).is_ok());
}
