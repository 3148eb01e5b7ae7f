//! The errors that a filling must keep, as the user writes them.

use crate::arguments::length_in_metres;
use sphere_fill::Target;
use trimesh::LengthUnit;

/// Reads `volume=1%,inertia=2%,surface=0.05mm`; a bare length is in the unit of the mesh.
///
/// # Errors
///
/// An unknown name, one given twice, or a value that is not a positive number.
pub(crate) fn target_of(text: &str, mesh: LengthUnit) -> anyhow::Result<Target> {
    const WANTED: &str = "expected volume=1%, inertia=2%, surface=0.05mm, or some of them";
    let mut target = Target::default();
    for part in text.split(',') {
        let (name, value) = part
            .split_once('=')
            .ok_or_else(|| anyhow::anyhow!("--target {text}: {WANTED}"))?;
        let (place, value) = match name.trim() {
            "volume" => (&mut target.volume, share_of(value)?),
            "inertia" => (&mut target.inertia, share_of(value)?),
            "surface" => (
                &mut target.surface,
                length_in_metres("target", value, mesh)?,
            ),
            other => anyhow::bail!("--target {other}: {WANTED}"),
        };
        anyhow::ensure!(
            place.is_none(),
            "--target {text}: {} is given twice",
            name.trim()
        );
        *place = Some(value);
    }
    Ok(target)
}

/// Reads `1%` or `0.01`.
fn share_of(text: &str) -> anyhow::Result<f64> {
    let text = text.trim();
    let (digits, factor) = text
        .strip_suffix('%')
        .map_or((text, 1.0), |digits| (digits, 0.01));
    let value = digits.trim().parse::<f64>().ok();
    value
        .map(|value| value * factor)
        .filter(|value| value.is_finite() && *value > 0.0)
        .ok_or_else(|| anyhow::anyhow!("--target {text}: expected a positive share such as 1%"))
}

#[cfg(test)]
mod tests {
    use super::target_of;
    use trimesh::LengthUnit::Millimetre;

    #[test]
    fn shares_and_lengths_are_read() {
        let found = target_of("volume=1%, inertia=0.02,surface=50um", Millimetre).unwrap();
        assert_eq!((found.volume, found.inertia), (Some(0.01), Some(0.02)));
        assert!((found.surface.unwrap() - 50e-6).abs() < 1e-18);
    }

    #[test]
    fn what_cannot_be_meant_is_refused() {
        for text in [
            "",
            "volume",
            "volume=x",
            "volume=-1%",
            "area=1%",
            "volume=1%,volume=2%",
        ] {
            let message = target_of(text, Millimetre).expect_err(text).to_string();
            assert!(message.contains("--target"), "{message}");
        }
    }
}
