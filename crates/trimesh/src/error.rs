//! Errors of a mesh or its file.

use crate::Proposal;
use crate::proposal::rounded_up;
use input::quantity::significant;

/// Why a mesh is refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file cannot be read.
    #[error("cannot read {path}: {source}")]
    Read {
        /// Path of the file.
        path: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file has no bytes.
    #[error("{file} is empty (0 bytes); expected a mesh (STL, OBJ or PLY)")]
    EmptyFile {
        /// File.
        file: String,
    },
    /// A text that is neither STL nor OBJ.
    #[error(
        "{file} is a text, but no STL, OBJ or PLY: it begins with `{start}`, not with `solid` and \
         `facet` or with `ply`, and no line `v x y z` was found; export the scan as a mesh"
    )]
    NotMesh {
        /// File.
        file: String,
        /// Its first line, shortened.
        start: String,
    },
    /// Points without triangles.
    #[error(
        "{file} is a point cloud, {points} without triangles between them; make a surface of it in the scanning software (such as \
         a screened Poisson reconstruction) and export that as STL, OBJ or PLY"
    )]
    PointCloud {
        /// File.
        file: String,
        /// Their number, in words.
        points: String,
    },
    /// A text in two-byte characters.
    #[error("{file} is a text in UTF-16: save it as UTF-8, or export the mesh as binary STL")]
    Utf16 {
        /// File.
        file: String,
    },
    /// A binary file whose length does not fit its triangle count.
    #[error(
        "{file} declares {declared} triangles, which takes {expected_bytes} bytes, but has \
         {actual_bytes}: it is cut off or damaged; export it again"
    )]
    LengthMismatch {
        /// File.
        file: String,
        /// Triangles that the header declares.
        declared: u32,
        /// Length that this takes, bytes.
        expected_bytes: u64,
        /// Length of the file, bytes.
        actual_bytes: u64,
    },
    /// More triangles than are handled.
    #[error("{file} has {triangles} triangles; at most {most} are handled: thin the mesh out")]
    TooManyTriangles {
        /// File.
        file: String,
        /// Triangles read.
        triangles: usize,
        /// Largest number.
        most: usize,
    },
    /// A word of an ASCII file is not what the format asks for.
    #[error("{file}, line {line}: expected {expected}, found `{found}`")]
    Syntax {
        /// File.
        file: String,
        /// Line, from 1.
        line: usize,
        /// What should are present.
        expected: &'static str,
        /// What is there, shortened.
        found: String,
    },
    /// The mesh has no triangle (left).
    #[error("{file} has no triangle that encloses anything ({read} read, {dropped} degenerate)")]
    NoTriangles {
        /// File.
        file: String,
        /// Triangles read.
        read: usize,
        /// Triangles dropped as degenerate or duplicate.
        dropped: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error(
        "{file}: triangle {triangle}, corner {corner} has the coordinate {value}; all must be finite"
    )]
    NotFinite {
        /// File.
        file: String,
        /// Index of the triangle, from 0.
        triangle: usize,
        /// Corner, 0 to 2.
        corner: usize,
        /// The value.
        value: f64,
    },
    /// All vertices lie in one plane, or the enclosed volume is nothing.
    #[error("{file} is flat: its thickness is {ratio:.1e} of its length; a body is needed")]
    Flat {
        /// File.
        file: String,
        /// Root of the smallest over the largest variance of the vertices.
        ratio: f64,
    },
    /// The surface has a hole.
    #[error(
        "{file} is not closed: {open_edges} edges belong to one triangle only, the first at \
         {} mm; holes: {holes}, the widest {} mm across; {way_out}",
        place(*x, *y, *z),
        significant(*widest_mm, 4)
    )]
    Open {
        /// File.
        file: String,
        /// Edges with one triangle.
        open_edges: usize,
        /// Holes whose rim is a simple loop.
        holes: usize,
        /// Diagonal of the box round the widest, mm.
        widest_mm: f64,
        /// Middle of the first such edge, mm.
        x: f64,
        /// See `x`.
        y: f64,
        /// See `x`.
        z: f64,
        /// What would mend it.
        way_out: Box<Proposal>,
    },
    /// A stack of slices whose sizes do not fit.
    #[error(
        "{file}: {counts:?} voxels of lengths above 0 were expected, {values} values are there"
    )]
    VoxelSizes {
        /// Folder.
        file: String,
        /// Numbers along x, y and z.
        counts: [usize; 3],
        /// Values.
        values: usize,
    },
    /// Cubes on which a surface cannot be rebuilt.
    #[error(
        "{file} cannot be rebuilt on cubes of {} mm: at least {} mm are handled, and from about {} mm on nothing is left of \
         it (seedfill: --rebuild)",
        significant(*cell_mm, 4),
        rounded_up(*least_mm),
        significant(*most_mm, 2)
    )]
    RebuildCell {
        /// File.
        file: String,
        /// Edge length asked for, mm.
        cell_mm: f64,
        /// Least edge length, mm.
        least_mm: f64,
        /// Half of the shortest side of the box, mm.
        most_mm: f64,
    },
    /// An edge belongs to more than two triangles.
    #[error(
        "{file}: {edges} edges belong to more than two triangles, the first at \
         {} mm; {way_out}",
        place(*x, *y, *z)
    )]
    NonManifold {
        /// File.
        file: String,
        /// Edges with more than two triangles.
        edges: usize,
        /// Middle of the first such edge, mm.
        x: f64,
        /// See `x`.
        y: f64,
        /// See `x`.
        z: f64,
        /// What would mend it.
        way_out: Box<Proposal>,
    },
    /// The surface has only one side.
    #[error("{file} cannot be oriented: its surface has one side only (as a Klein bottle)")]
    NotOrientable {
        /// File.
        file: String,
    },
    /// More than one body, or shells that cut each other.
    #[error(
        "{file} holds {bodies} separate or intersecting bodies in {shells} shells; the largest \
         enclose {volumes_mm3} mm3; {}",
        parting(*bodies, *apart, way_out)
    )]
    SeveralBodies {
        /// File.
        file: String,
        /// Shells that bound a body from outside.
        bodies: usize,
        /// All connected surfaces.
        shells: usize,
        /// Volumes of the largest, mm³.
        volumes_mm3: String,
        /// Bodies if those that cross count as one.
        apart: usize,
        /// What makes one body of those that cross.
        way_out: Box<Proposal>,
    },
    /// The surface cuts itself.
    #[error(
        "{file} cuts itself: {pairs} pairs of triangles cross, the first at {} mm, and \
         {folded_percent:.1} % of the surface does not part inside from outside: {way_out}",
        place(*x, *y, *z)
    )]
    CutsItself {
        /// File.
        file: String,
        /// Pairs of triangles that cross.
        pairs: usize,
        /// Share of the area that does not part inside from outside, %.
        folded_percent: f64,
        /// Where the first pair crosses, mm.
        x: f64,
        /// See `x`.
        y: f64,
        /// See `x`.
        z: f64,
        /// What would mend it.
        way_out: Box<Proposal>,
    },
    /// The unit is not known.
    #[error("unknown unit of length `{found}`; use mm, cm, m or um")]
    UnknownUnit {
        /// What was given.
        found: String,
    },
    /// A shape was asked for with sizes that make no body.
    #[error("{what} is {value}; it must be {must}")]
    BadShape {
        /// Which size.
        what: &'static str,
        /// Its value, SI.
        value: f64,
        /// What is allowed.
        must: &'static str,
    },
}

/// A place for a message, mm, with digits for bodies of every size.
fn place(x: f64, y: f64, z: f64) -> String {
    let [x, y, z] = [x, y, z].map(|coordinate| significant(coordinate, 6));
    format!("({x}, {y}, {z})")
}

/// What makes one body of several: those that cross are joined, of others the largest is kept.
fn parting(bodies: usize, apart: usize, join: &Proposal) -> String {
    let keep = "keep the largest (seedfill: --largest-body)";
    if apart == bodies {
        keep.to_owned()
    } else if apart == 1 {
        format!("they cross each other: {join}")
    } else {
        format!("some cross each other: {join}; then {keep}")
    }
}
