//! Contour lines and the areas above a level, from values on a lattice.
//!
//! Each cell is cut by the level; inside a cell the field is taken as bilinear. A cell whose
//! corners alternate is decided by the value of the bilinear field at its saddle point
//! `[Nielson1991]`: with corners a, b, c, d in turn it is (a c - b d) / (a + c - b - d), and the two
//! high corners are joined where it is at or above the level. Lines and areas come from the same
//! walk, so that the edge of an area is always the line of the same level.

/// Values on a lattice of straight lines.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lattice<'a> {
    /// Columns, ascending, at least 2.
    pub(crate) x: &'a [f64],
    /// Rows, ascending, at least 2.
    pub(crate) y: &'a [f64],
    /// Values row by row, x fastest.
    pub(crate) values: &'a [f64],
}

/// A contour line in the units of the lattice.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ContourLine {
    /// Points in order; higher values lie to the left. A closed line repeats its first point.
    pub(crate) points: Vec<[f64; 2]>,
}

/// All lines at a level; open ones end at the edge of the lattice.
pub(crate) fn contour_lines(lattice: &Lattice<'_>, level: f64) -> Vec<ContourLine> {
    Walk::new(lattice, level, Border::Open).lines()
}

/// Closed loops around the area at or above a level; a loop inside of another is a hole.
pub(crate) fn area_at_or_above(lattice: &Lattice<'_>, level: f64) -> Vec<ContourLine> {
    Walk::new(lattice, level, Border::Closed).lines()
}

/// What lies around the lattice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Border {
    /// Nothing: lines end there.
    Open,
    /// A rim of no width below every level: lines run along the edge and close.
    Closed,
}

/// A crossing of the level with an edge of the lattice; edges are numbered.
type Edge = usize;

/// The level's crossings and how they follow each other.
#[derive(Debug)]
struct Walk<'a> {
    /// The values.
    lattice: &'a Lattice<'a>,
    level: f64,
    /// Columns of rim on each side: 0 or 1.
    rim: usize,
    /// Number of columns with the rim.
    columns: usize,
    /// Number of rows with the rim.
    rows: usize,
    /// For each edge the one that follows on the line, if the line continues from there.
    next: Vec<Option<Edge>>,
    /// Whether a line comes to the edge.
    reached: Vec<bool>,
}

impl<'a> Walk<'a> {
    /// Finds all pieces.
    fn new(lattice: &'a Lattice<'a>, level: f64, border: Border) -> Self {
        let rim = usize::from(border == Border::Closed);
        let columns = lattice.x.len() + 2 * rim;
        let rows = lattice.y.len() + 2 * rim;
        let edges = 2 * columns * rows;
        let next = vec![None; edges];
        let reached = vec![false; edges];
        let mut walk = Self {
            lattice,
            level,
            rim,
            columns,
            rows,
            next,
            reached,
        };
        for row in 0..rows - 1 {
            for column in 0..columns - 1 {
                walk.cut_cell(column, row);
            }
        }
        walk
    }

    /// Value at a node; the rim is below everything.
    fn value(&self, column: usize, row: usize) -> f64 {
        let node = column.checked_sub(self.rim).zip(row.checked_sub(self.rim));
        node.filter(|&(column, row)| column < self.lattice.x.len() && row < self.lattice.y.len())
            .map_or(f64::NEG_INFINITY, |(column, row)| {
                self.lattice.values[row * self.lattice.x.len() + column]
            })
    }

    /// Place of a node; the rim lies on the outermost nodes.
    fn place(&self, column: usize, row: usize) -> [f64; 2] {
        let nearest = |index: usize, count: usize| index.saturating_sub(self.rim).min(count - 1);
        let Lattice { x, y, .. } = self.lattice;
        [x[nearest(column, x.len())], y[nearest(row, y.len())]]
    }

    /// Number of the edge from a node to its right (or upper) neighbour.
    fn edge(&self, column: usize, row: usize, upward: usize) -> Edge {
        2 * (row * self.columns + column) + upward
    }

    /// Finds the pieces of line in the cell above and to the right of a node.
    fn cut_cell(&mut self, column: usize, row: usize) {
        // Corners and edges counter-clockwise from the lower left; edge k joins corners k, k + 1.
        let corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
            .map(|(right, up)| self.value(column + right, row + up));
        let edges = [
            self.edge(column, row, 0),
            self.edge(column + 1, row, 1),
            self.edge(column, row + 1, 0),
            self.edge(column, row, 1),
        ];
        let above = corners.map(|value| value >= self.level);
        let falls = |k: usize| above[k] && !above[(k + 1) % 4];
        let rises = |k: usize| !above[k] && above[(k + 1) % 4];
        let saddle = (0..4).filter(|&k| falls(k)).count() == 2;
        for start in (0..4).filter(|&k| falls(k)) {
            let end = if saddle && high_corners_join(corners, self.level) {
                // The low corner after this edge is cut off.
                Some((start + 1) % 4)
            } else if saddle {
                // The high corner before this edge is cut off.
                Some((start + 3) % 4)
            } else {
                (0..4).find(|&k| rises(k))
            };
            if let Some(end) = end {
                self.next[edges[start]] = Some(edges[end]);
                self.reached[edges[end]] = true;
            }
        }
    }

    /// Strings the pieces together: open lines first, then closed ones.
    fn lines(mut self) -> Vec<ContourLine> {
        let mut lines = Vec::new();
        for start in 0..self.next.len() {
            if !self.reached[start] && self.next[start].is_some() {
                lines.push(self.follow(start));
            }
        }
        for start in 0..self.next.len() {
            if self.next[start].is_some() {
                lines.push(self.follow(start));
            }
        }
        lines
    }

    /// Follows one line from an edge and takes it out of the walk.
    fn follow(&mut self, start: Edge) -> ContourLine {
        let mut points = vec![self.crossing(start)];
        let mut edge = start;
        while let Some(next) = self.next[edge].take() {
            let point = self.crossing(next);
            if points.last() != Some(&point) {
                points.push(point);
            }
            edge = next;
        }
        ContourLine { points }
    }

    /// Where the level crosses an edge, by linear interpolation.
    fn crossing(&self, edge: Edge) -> [f64; 2] {
        let (node, upward) = (edge / 2, edge % 2);
        let (column, row) = (node % self.columns, node / self.columns);
        debug_assert!(row < self.rows, "edge {edge} lies on the lattice");
        let (far_column, far_row) = (column + 1 - upward, row + upward);
        let [near, far] = [self.value(column, row), self.value(far_column, far_row)];
        let [from, to] = [self.place(column, row), self.place(far_column, far_row)];
        if near.is_infinite() || far.is_infinite() {
            return from;
        }
        let share = (self.level - near) / (far - near);
        [
            from[0] + share * (to[0] - from[0]),
            from[1] + share * (to[1] - from[1]),
        ]
    }
}

/// Whether the two high corners of a cell with alternating corners belong together.
fn high_corners_join(corners: [f64; 4], level: f64) -> bool {
    let [a, b, c, d] = corners;
    let curvature = a + c - b - d;
    // Corners at infinity never alternate, and the denominator cannot vanish when they do.
    (a * c - b * d) / curvature >= level
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twice the enclosed area of a closed loop, positive counter-clockwise.
    fn double_area(line: &ContourLine) -> f64 {
        line.points
            .windows(2)
            .map(|p| p[0][0] * p[1][1] - p[1][0] * p[0][1])
            .sum()
    }

    /// A lattice from -1 to 1 with values of a function.
    fn sampled(n: u32, function: impl Fn(f64, f64) -> f64) -> (Vec<f64>, Vec<f64>) {
        let axis: Vec<f64> = (0..n)
            .map(|i| 2.0 * f64::from(i) / f64::from(n - 1) - 1.0)
            .collect();
        let values = axis.iter().flat_map(|&y| axis.iter().map(move |&x| (x, y)));
        let values = values.map(|(x, y)| function(x, y)).collect();
        (axis, values)
    }

    #[test]
    fn plane_has_one_straight_line_exactly_where_the_level_is() {
        let (axis, values) = sampled(9, |x, y| x + 2.0 * y);
        let lattice = Lattice {
            x: &axis,
            y: &axis,
            values: &values,
        };
        let lines = contour_lines(&lattice, 0.3);
        assert_eq!(lines.len(), 1);
        // Linear interpolation is exact for a plane: rounding only.
        assert!(
            lines[0]
                .points
                .iter()
                .all(|p| (p[0] + 2.0 * p[1] - 0.3).abs() < 1e-14)
        );
        let ends = [
            lines[0].points[0],
            lines[0].points[lines[0].points.len() - 1],
        ];
        assert!(
            ends.iter().all(|p| p[0].abs() == 1.0 || p[1].abs() == 1.0),
            "{ends:?}"
        );
    }

    #[test]
    fn circle_is_one_closed_loop_with_the_area_of_the_circle() {
        for n in [41, 81] {
            let (axis, values) = sampled(n, |x, y| 1.0 - x * x - y * y);
            let lattice = Lattice {
                x: &axis,
                y: &axis,
                values: &values,
            };
            let lines = contour_lines(&lattice, 0.5);
            assert_eq!(lines.len(), 1);
            assert_eq!(lines[0].points.first(), lines[0].points.last());
            let area = 0.5 * double_area(&lines[0]);
            // Chords and linear interpolation lose an area of order h^2.
            let h = 2.0 / f64::from(n - 1);
            let expected = std::f64::consts::FRAC_PI_2;
            assert!(
                (area - expected).abs() < 2.0 * h * h,
                "{area} at spacing {h}"
            );
            assert_eq!(area_at_or_above(&lattice, 0.5).len(), 1);
        }
    }

    #[test]
    fn high_values_lie_to_the_left_so_hills_turn_counter_clockwise() {
        let (axis, values) = sampled(21, |x, y| x * x + y * y);
        let lattice = Lattice {
            x: &axis,
            y: &axis,
            values: &values,
        };
        assert!(
            double_area(&contour_lines(&lattice, 0.25)[0]) < 0.0,
            "a hollow turns clockwise"
        );
    }

    #[test]
    fn saddle_is_joined_by_the_value_at_its_saddle_point() {
        // Corners 1, 0, 3, 0 (counter-clockwise): saddle point value (1*3 - 0) / 4 = 0.75.
        // The mean of the corners is 1.0 and would decide wrongly between 0.75 and 1.
        let lattice = Lattice {
            x: &[0.0, 1.0],
            y: &[0.0, 1.0],
            values: &[1.0, 0.0, 0.0, 3.0],
        };
        for (level, joined) in [(0.5, true), (0.74, true), (0.76, false), (0.9, false)] {
            let loops = area_at_or_above(&lattice, level);
            assert_eq!(loops.len(), if joined { 1 } else { 2 }, "level {level}");
            let lines = contour_lines(&lattice, level);
            assert_eq!(lines.len(), 2, "level {level}");
            // Joined high corners: each line cuts off a low corner, (1, 0) or (0, 1), and so
            // stays on one side of the diagonal x = y.
            for line in lines {
                let sides: Vec<bool> = line.points.iter().map(|p| p[0] > p[1]).collect();
                assert_eq!(sides[0] == sides[1], joined, "level {level}: {line:?}");
            }
        }
    }

    #[test]
    fn area_has_the_right_size_with_holes_and_at_the_border() {
        // |x| + |y| >= 0.5 inside of the square: 4 minus the diamond of area 0.5.
        let (axis, values) = sampled(9, |x, y| x.abs() + y.abs());
        let lattice = Lattice {
            x: &axis,
            y: &axis,
            values: &values,
        };
        let loops = area_at_or_above(&lattice, 0.5);
        assert_eq!(loops.len(), 2, "outer edge and hole");
        let area: f64 = loops.iter().map(|line| 0.5 * double_area(line)).sum();
        assert!((area - 3.5).abs() < 1e-12, "{area}");
        assert!(
            loops
                .iter()
                .all(|line| line.points.first() == line.points.last())
        );
    }

    #[test]
    fn level_outside_of_all_values_gives_nothing_or_everything() {
        let (axis, values) = sampled(5, |x, y| x * y);
        let lattice = Lattice {
            x: &axis,
            y: &axis,
            values: &values,
        };
        assert!(contour_lines(&lattice, 2.0).is_empty());
        assert!(contour_lines(&lattice, -2.0).is_empty());
        assert!(area_at_or_above(&lattice, 2.0).is_empty());
        let everything = area_at_or_above(&lattice, -2.0);
        assert_eq!(everything.len(), 1);
        assert!((0.5 * double_area(&everything[0]) - 4.0).abs() < 1e-12);
    }

    #[test]
    fn values_equal_to_the_level_break_no_line() {
        let (axis, values) = sampled(5, |x, y| (2.0 * x).round().max((2.0 * y).round()));
        let lattice = Lattice {
            x: &axis,
            y: &axis,
            values: &values,
        };
        for line in area_at_or_above(&lattice, 1.0) {
            assert_eq!(line.points.first(), line.points.last());
        }
        for line in contour_lines(&lattice, 1.0) {
            assert!(line.points.iter().flatten().all(|value| value.is_finite()));
        }
    }
}
