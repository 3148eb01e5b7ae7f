//! `[coarse_graining]`: what it gives, and what it refuses.

use super::folder::{Folder, STUDY, wrong};
use super::refused::tells;
use campaign::Simulator as _;
use study::Study;

/// The study of peas with a table, and without effects.
fn peas(table: &str) -> String {
    format!("{STUDY}\n[effects]\nsearch = []\n[coarse_graining]\n{table}\n")
}

/// The message of a table that is wrong.
fn refused(table: &str) -> String {
    wrong(&peas(table))
}

/// Both conditions of the drum have coarse grains and the sled does not; sizes are told from the coarsest on. Runs with coarser grains cost
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
    assert!(simulator.inputs(&request).is_ok());
}

#[test]
fn what_tells_no_trend_is_refused_with_its_line() {
    let drum = "scenes = [\"drum\"]";
    for (factors, word) in [
        ("[3.0]", "needs two or more"),
        ("[3.0, 0.5]", "the grains of the scene are the real ones"),
        ("[2.0, 0]", "has 0: a factor must be above 1"),
        ("[2.0, 2.0]", "has one size twice"),
        ("[\"4 mm\", \"3 mm\"]", "without a unit"),
        ("[20.0, 2.0]", "take finer grains"),
    ] {
        tells(
            &refused(&format!("{drum}\nfactors = {factors}")),
            &["line", "factors", word],
        );
    }
    tells(
        &refused("scenes = [\"drun\"]\nfactors = [3.0, 2.0]"),
        &["'drun' is no [[scene]]"],
    );
    tells(
        &refused("scenes = [\"sled\"]\nfactors = [3.0, 2.0]"),
        &["single seeds"],
    );
    tells(
        &refused("scenes = []\nfactors = [3.0, 2.0]"),
        &["name the scenes"],
    );
    tells(&refused("factors = [3.0, 2.0]"), &["has no 'scenes'"]);
    tells(
        &refused(&format!("{drum}\nfactors = [3.0, 2.0]\nerror = 0.0")),
        &["must be above 0"],
    );
    tells(
        &refused(&format!("{drum}\nsizes = [3.0, 2.0]")),
        &["there are scenes, factors, error"],
    );
    let effects = format!("{STUDY}\n[coarse_graining]\n{drum}\nfactors = [1.6, 1.33]\n");
    let error = Folder::new(&effects).read(None).unwrap_err();
    tells(&error.to_string(), &["search = [] in [effects]"]);
}
