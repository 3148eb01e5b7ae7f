//! Names that other codes give to settings here, and how their values are converted.

/// A name as people bring it, the key here, and what to know about the value.
type Row = (&'static [&'static str], &'static str, &'static str);

/// Names without blanks, underscores, hyphens and capitals. The formulas: linear elasticity of isotropic bodies;
/// pull-off force `[JohnsonKendallRoberts1971]`.
const ROWS: [Row; 28] = [
    (
        &[
            "youngmodulus",
            "young",
            "elasticmodulus",
            "modulusofelasticity",
        ],
        "youngs_modulus",
        "a text with its unit, such as \"13 MPa\"",
    ),
    (
        &["shearmod", "modulusofrigidity", "rigidity"],
        "shear_modulus",
        "a text with its unit, such as \"5 MPa\"",
    ),
    (
        &["bulkmodulus"],
        "youngs_modulus",
        "E = 3 K (1 - 2 nu) of the bulk modulus K",
    ),
    (
        &["normalstiffness", "kn", "stiffness", "springconstant"],
        "youngs_modulus",
        "contacts are Hertzian and have no constant stiffness",
    ),
    (
        &["poisson", "poissonsratio", "nu"],
        "poisson_ratio",
        "the same number",
    ),
    (
        &[
            "coefficientofrestitution",
            "coefficientrestitution",
            "restitutioncoefficient",
            "cor",
        ],
        "restitution",
        "the same number",
    ),
    (
        &["damping", "dampingratio", "dampingcoefficient"],
        "restitution",
        "the dashpot follows from it",
    ),
    (
        &[
            "friction",
            "frictioncoefficient",
            "coefficientoffriction",
            "coefficientfriction",
            "coefficientofstaticfriction",
            "staticfrictioncoefficient",
            "slidingfriction",
            "mu",
        ],
        "static_friction",
        "the same number",
    ),
    (
        &["dynamicfriction", "kineticfriction"],
        "static_friction",
        "one coefficient holds at rest and in motion; friction_rate changes it with the speed",
    ),
    (
        &["frictionangle"],
        "static_friction",
        "the tangent of the angle",
    ),
    (
        &[
            "coefficientofrollingfriction",
            "coefficientrollingfriction",
            "rollingfrictioncoefficient",
            "rollingresistance",
            "mur",
        ],
        "rolling_friction",
        "model.rolling_lever states the arm that it belongs to",
    ),
    (
        &["cohesionenergydensity"],
        "cohesion_energy_density_j_m3",
        "J/m3",
    ),
    (
        &["workofadhesion"],
        "attraction_n",
        "the force of pull-off in N, 3/2 pi w R* of the work of adhesion w and the effective radius R*",
    ),
    (
        &["surfaceenergy"],
        "attraction_n",
        "the force of pull-off in N: 3/2 pi gamma R* of EDEM's surface energy, 3 pi gamma R* if gamma is that of one surface; \
         R* is the effective radius",
    ),
    (&["diameter"], "sphere", "the diameter, such as \"6 mm\""),
    (&["radius"], "sphere", "the diameter: twice the radius"),
    (
        &["diameter", "drumdiameter"],
        "inner_diameter",
        "without the thickness of the wall",
    ),
    (
        &["radius", "drumradius", "innerradius"],
        "inner_diameter",
        "twice the inner radius",
    ),
    (
        &["length", "depth", "thickness", "axiallength"],
        "width",
        "the inner width along the axis",
    ),
    (
        &[
            "rpm",
            "angularvelocity",
            "rotationspeed",
            "rotationalspeed",
            "omega",
        ],
        "speed",
        "such as \"15 rpm\" or \"1.6 rad/s\"",
    ),
    (
        &["velocity", "liftvelocity", "liftingspeed"],
        "lift_speed",
        "such as \"20 mm/s\"",
    ),
    (
        &["rho", "particledensity", "soliddensity", "seeddensity"],
        "density",
        "that of a seed, such as \"1250 kg/m3\"",
    ),
    (
        &[
            "number",
            "particles",
            "particlecount",
            "seedcount",
            "nparticles",
        ],
        "count",
        "the same number",
    ),
    (
        &[
            "fill",
            "fillinglevel",
            "fillinglvl",
            "fillingdegree",
            "fillingratio",
        ],
        "fill_level",
        "the share of the apparatus that the settled bed takes, 0 to 1",
    ),
    (
        &["bulkdensity", "packingfraction"],
        "solid_fraction",
        "the bulk density over that of a seed; beside fill_level",
    ),
    (
        &["clump", "multisphere", "spherefile"],
        "spheres",
        "a file with the columns x, y, z, radius",
    ),
    (&["dt", "step"], "time_step", "such as \"10 us\""),
    (&["gravity", "g"], "gravity_m_s2", "its size in m/s2"),
];

/// What to write for a name that is none here, if it is a usual one of another code and one of the `known` keys is meant.
pub(crate) fn way_out(name: &str, known: impl Fn(&str) -> bool) -> Option<String> {
    let plain: String = name
        .chars()
        .filter(|c| c.is_alphanumeric())
        .flat_map(char::to_lowercase)
        .collect();
    let same = |key: &str| key.replace('_', "") == plain;
    let row = ROWS
        .iter()
        .find(|(names, key, _)| known(key) && (names.contains(&plain.as_str()) || same(key)))?;
    let (_, key, note) = row;
    Some(format!("{name} is called {key} here ({note})"))
}

#[cfg(test)]
mod tests {
    use crate::{Override, Scene};
    use std::path::Path;

    const DRUM: &str = r#"
        apparatus = { kind = "drum", inner_diameter = "100 mm", width = "20 mm", speed = "15 rpm", shell = "w", cover = "w" }
        seed = [{ name = "pea", sphere = "6 mm", density = "1250 kg/m3", count = 20, material = "pea" }]
        material.pea = { poisson_ratio = 0.3, shear_modulus = "5 MPa" }
        material.w = { poisson_ratio = 0.3, shear_modulus = "1 GPa" }
        contact.pea-pea = { restitution = 0.5, static_friction = 0.4 }
        contact.pea-w = { restitution = 0.5, static_friction = 0.3 }
    "#;

    /// Each name that another code has for a setting is answered with the setting and its conversion, in a file and behind --set.
    #[test]
    fn names_of_other_codes_have_a_way_out() {
        let file = "drum.toml";
        let read = |text: &str, set: &[Override]| Scene::from_text(text, file, Path::new(""), set);
        read(DRUM, &[]).unwrap();
        for (key, other, words) in [
            (
                "shear_modulus = \"5 MPa\"",
                "youngsModulus = \"13 MPa\"",
                "youngs_modulus",
            ),
            (
                "shear_modulus = \"5 MPa\"",
                "bulk_modulus = \"9 MPa\"",
                "E = 3 K (1 - 2 nu)",
            ),
            (
                "restitution",
                "coefficient_of_restitution",
                "called restitution",
            ),
            (
                "static_friction = 0.4",
                "friction = 0.4",
                "called static_friction",
            ),
            ("static_friction = 0.4", "friction_angle = 22", "tangent"),
            (
                "sphere = \"6 mm\"",
                "radius = \"3 mm\"",
                "sphere here (the diameter: twice",
            ),
            (
                "inner_diameter = \"100 mm\"",
                "radius = \"50 mm\"",
                "inner_diameter here (twice",
            ),
            ("density", "rho", "called density"),
        ] {
            let told = read(&DRUM.replacen(key, other, 1), &[])
                .unwrap_err()
                .to_string();
            assert!(told.contains(words), "{other}: {told}");
        }
        for (name, words) in [
            (
                "contact.pea-pea.coefficient_of_restitution",
                "called restitution",
            ),
            ("contact.pea-pea.friction", "called static_friction"),
            ("seed.0.radius", "sphere here"),
            ("apparatus.radius", "inner_diameter here"),
        ] {
            let set = Override {
                name: name.into(),
                value: "0.5".into(),
            };
            let told = read(DRUM, &[set]).unwrap_err().to_string();
            assert!(told.contains(words), "{name}: {told}");
        }
        // A name that no code has is answered as before.
        let odd = read(&DRUM.replacen("density", "qwertz", 1), &[]).unwrap_err();
        assert!(!odd.to_string().contains("is called"), "{odd}");
    }
}
