//! Places and boxes on the paper.

/// A place, px from the upper left corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Point {
    /// To the right, px.
    pub(crate) x: f64,
    /// Downward, px.
    pub(crate) y: f64,
}

/// Short form for points.
pub(crate) const fn at(x: f64, y: f64) -> Point {
    Point { x, y }
}

/// A box, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rect {
    /// Left edge.
    pub(crate) left: f64,
    /// Upper edge.
    pub(crate) top: f64,
    /// Right edge.
    pub(crate) right: f64,
    /// Lower edge.
    pub(crate) bottom: f64,
}

impl Rect {
    /// Width, px.
    pub(crate) fn width(&self) -> f64 {
        self.right - self.left
    }

    /// Height, px.
    pub(crate) fn height(&self) -> f64 {
        self.bottom - self.top
    }

    /// The box with more room on every side.
    pub(crate) fn grown(&self, by: f64) -> Self {
        Self {
            left: self.left - by,
            top: self.top - by,
            right: self.right + by,
            bottom: self.bottom + by,
        }
    }

    /// Whether two boxes share any area.
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    /// Whether another box lies inside.
    pub(crate) fn holds(&self, other: &Self) -> bool {
        self.left <= other.left
            && other.right <= self.right
            && self.top <= other.top
            && other.bottom <= self.bottom
    }
}
