//! Charts as pictures of pixels.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};

use crate::{Error, Svg};

/// Pixels of the picture per pixel of the chart.
const SCALE: f32 = 2.0;

/// Turns charts into PNG files. It holds the fonts of the machine, so make it once for many charts.
///
/// The letters are those of the machine's own sans-serif font; where it has none, the text is
/// missing: ask [`PngPrinter::has_fonts`].
#[derive(Debug)]
pub struct PngPrinter {
    /// Fonts and the like.
    options: Options<'static>,
}

impl Default for PngPrinter {
    fn default() -> Self {
        Self::new()
    }
}

impl PngPrinter {
    /// Reads the fonts of the machine.
    pub fn new() -> Self {
        let mut options = Options::default();
        let fonts = options.fontdb_mut();
        fonts.load_system_fonts();
        // The generic family is looked up by a name that the machine may not have.
        let first = fonts.faces().find_map(|face| {
            let family = face.families.first().map(|(name, _)| name.clone())?;
            family.to_lowercase().contains("sans").then_some(family)
        });
        if let Some(family) = first {
            fonts.set_sans_serif_family(family);
        }
        Self { options }
    }

    /// Whether the machine has any font.
    pub fn has_fonts(&self) -> bool {
        self.options.fontdb.faces().next().is_some()
    }

    /// A chart as the bytes of a PNG file of twice its size.
    ///
    /// # Errors
    /// [`Error::Png`] if the chart cannot be turned into pixels.
    pub fn print(&self, chart: &Svg) -> Result<Vec<u8>, Error> {
        let fault = |reason: String| Error::Png { reason };
        let tree = Tree::from_str(chart.as_str(), &self.options)
            .map_err(|error| fault(error.to_string()))?;
        let size = tree
            .size()
            .to_int_size()
            .scale_by(SCALE)
            .ok_or_else(|| fault("the chart has no size".to_owned()))?;
        let mut pixels = Pixmap::new(size.width(), size.height())
            .ok_or_else(|| fault("the chart is too large".to_owned()))?;
        let transform = Transform::from_scale(SCALE, SCALE);
        resvg::render(&tree, transform, &mut pixels.as_mut());
        pixels
            .encode_png()
            .map_err(|error| fault(error.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::PngPrinter;
    use crate::{AxisTitle, Scatter};

    /// The file starts with the signature of PNG, and its size is twice that of the chart.
    #[test]
    fn a_chart_becomes_a_png_of_twice_its_size() {
        let chart = Scatter {
            x: AxisTitle::new("a", ""),
            y: AxisTitle::new("b", ""),
            points: vec![[0.0, 1.0], [1.0, 2.0]],
            names: Vec::new(),
            marked: Vec::new(),
            line: None,
            levels: Vec::new(),
        };
        let png = PngPrinter::new().print(&chart.draw().unwrap()).unwrap();
        assert_eq!(
            png[..8],
            [0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1a, b'\n']
        );
        let size = |from: usize| u32::from_be_bytes(png[from..from + 4].try_into().unwrap());
        assert_eq!((size(16), size(20)), (1280, 820));
    }
}
