//! The pictures of the report, by name; the same are written as files.

pub(crate) mod beds;
pub(crate) mod design_run_pictures;
pub(crate) mod measurement_charts;
pub(crate) mod photographs;
pub(crate) mod residual_charts;
pub(crate) mod run_charts;
pub(crate) mod screening_charts;
pub(crate) mod solution_charts;
pub(crate) mod surface_charts;

use crate::output::DIAGNOSIS;
use crate::{Error, ReportInput};
use inference::DiagnosisStage;
use report::Svg;

/// Contents of a picture.
#[derive(Debug)]
pub(crate) enum Picture {
    /// A chart.
    Chart(Svg),
    /// Bytes of a PNG file.
    Png(Vec<u8>),
}

/// A picture with its name.
#[derive(Debug)]
pub(crate) struct NamedPicture {
    /// Name without ending; small letters, digits and hyphens.
    pub(crate) name: String,
    /// Contents.
    pub(crate) picture: Picture,
    /// Whether it is written as a file as well.
    pub(crate) is_file: bool,
}

impl NamedPicture {
    /// A chart.
    fn chart(name: impl Into<String>, svg: Svg) -> Self {
        Self {
            name: name.into(),
            picture: Picture::Chart(svg),
            is_file: true,
        }
    }

    /// A PNG file.
    fn png(name: impl Into<String>, bytes: Vec<u8>) -> Self {
        Self {
            name: name.into(),
            picture: Picture::Png(bytes),
            is_file: true,
        }
    }

    /// The same, but only in the page: there may be hundreds.
    fn only_in_page(self) -> Self {
        Self {
            is_file: false,
            ..self
        }
    }

    /// Name of its file.
    pub(crate) fn file_name(&self) -> String {
        match self.picture {
            Picture::Chart(_) => format!("{}.svg", self.name),
            Picture::Png(_) => format!("{}.png", self.name),
        }
    }
}

/// The chart of a name; none where it could not be made of the runs.
pub(crate) fn chart<'a>(pictures: &'a [NamedPicture], name: &str) -> Option<&'a Svg> {
    pictures
        .iter()
        .find(|p| p.name == name)
        .and_then(|p| match &p.picture {
            Picture::Chart(svg) => Some(svg),
            Picture::Png(_) => None,
        })
}

/// The PNG of a name.
pub(crate) fn png<'a>(pictures: &'a [NamedPicture], name: &str) -> Option<&'a [u8]> {
    pictures
        .iter()
        .find(|p| p.name == name)
        .and_then(|p| match &p.picture {
            Picture::Png(bytes) => Some(bytes.as_slice()),
            Picture::Chart(_) => None,
        })
}

/// A name of a file from any text.
pub(crate) fn plain_name(text: &str) -> String {
    let letter = |c: char| {
        if c.is_ascii_alphanumeric() {
            c.to_ascii_lowercase()
        } else {
            '-'
        }
    };
    text.chars().map(letter).collect()
}

/// Draws all pictures of a calibration.
pub(crate) fn pictures(input: &ReportInput<'_>) -> Result<Vec<NamedPicture>, Error> {
    let mut all = Vec::new();
    all.extend(measurement_charts::chart(input)?);
    all.extend(solution_charts::charts(input)?);
    for (number, screening) in input.calibration.screening.iter().enumerate() {
        all.extend(screening_charts::charts(number, screening)?);
    }
    all.extend(surface_charts::charts(input)?);
    all.extend(design_run_pictures::pictures(input)?);
    all.extend(photographs::frames(input)?);
    all.extend(beds::pictures(input)?);
    all.extend(run_charts::series(input)?);
    if let DiagnosisStage::Done(study) = &input.calibration.diagnosis {
        all.extend(residual_charts::charts(DIAGNOSIS, study)?);
    }
    all.extend(photographs::seeds(input)?);
    Ok(all)
}
