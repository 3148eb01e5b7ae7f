//! Which triangles meet at an edge, which shells they form, and which way they face.

use crate::BoundingBox;
use crate::winding_tree::WindingTree;
use nalgebra::Vector3;
use std::cell::OnceCell;

/// Shells beyond this number are not tested against each other: the cost grows with its square and is then some seconds.
const SHELLS_TESTED: usize = 3000;

/// Vertices of one shell that are tested for lying inside another.
const VERTICES_TESTED: usize = 24;

/// Mark of a side beyond which there is no triangle.
const NONE: u32 = u32::MAX;

/// Mark of a side beyond which there are several triangles.
const SEVERAL: u32 = u32::MAX - 1;

/// What lies beyond each side of each triangle.
#[derive(Debug, Clone)]
pub(crate) struct Edges {
    /// Per triangle and side: twice the triangle beyond, plus one if both run the same way (a
    /// fault); or [`NONE`] or [`SEVERAL`].
    beyond: Vec<[u32; 3]>,
    /// Edges with one triangle.
    pub(crate) open: Vec<[usize; 2]>,
    /// Edges with more than two triangles.
    pub(crate) crowded: Vec<[usize; 2]>,
}

/// A side at the vertex of lower index.
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    /// The vertex of higher index.
    other: u32,
    triangle: u32,
    /// Which of its sides, times two, plus one if it runs from the higher to the lower index.
    place: u8,
}

impl Edges {
    /// Pairs up the sides of all triangles; indices must have 31 bits.
    pub(crate) fn new(triangles: &[[usize; 3]]) -> Self {
        let (starts, sides) = sides_by_lower_vertex(triangles);
        let mut edges = Self {
            beyond: vec![[NONE; 3]; triangles.len()],
            open: Vec::new(),
            crowded: Vec::new(),
        };
        for (lower, range) in starts.windows(2).enumerate() {
            let of_vertex = &sides[range[0] as usize..range[1] as usize];
            for group in of_vertex.chunk_by(|a, b| a.other == b.other) {
                let edge = [lower, group[0].other as usize];
                match group {
                    [_] => edges.open.push(edge),
                    [a, b] => {
                        let same = u32::from(a.place % 2 == b.place % 2);
                        let place = |side: &Side| (side.triangle as usize, side.place as usize / 2);
                        let ((t, k), (u, l)) = (place(a), place(b));
                        edges.beyond[t][k] = 2 * b.triangle + same;
                        edges.beyond[u][l] = 2 * a.triangle + same;
                    }
                    _ => {
                        for side in group {
                            edges.beyond[side.triangle as usize][side.place as usize / 2] = SEVERAL;
                        }
                        edges.crowded.push(edge);
                    }
                }
            }
        }
        edges
    }

    /// Triangle beyond a side, if the side has exactly one.
    pub(crate) fn beyond(&self, triangle: usize, side: usize) -> Option<usize> {
        let code = self.beyond[triangle][side];
        (code < SEVERAL).then_some(code as usize / 2)
    }

    /// Whether nothing lies beyond a side.
    pub(crate) fn is_open(&self, triangle: usize, side: usize) -> bool {
        self.beyond[triangle][side] == NONE
    }

    /// Triangles beyond all sides, and whether they run the same way.
    fn around(&self, triangle: usize) -> impl Iterator<Item = (usize, bool)> {
        let codes = self.beyond[triangle];
        let found = codes.into_iter().filter(|&code| code < SEVERAL);
        found.map(|code| (code as usize / 2, code % 2 == 1))
    }
}

/// All sides sorted by the lower vertex (a counting sort), then by the higher one.
fn sides_by_lower_vertex(triangles: &[[usize; 3]]) -> (Vec<u32>, Vec<Side>) {
    let pairs = |t: &[usize; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    let n = triangles.iter().flatten().max().map_or(0, |most| most + 1);
    let mut starts = vec![0_u32; n + 1];
    for [from, to] in triangles.iter().flat_map(pairs) {
        starts[from.min(to) + 1] += 1;
    }
    for i in 0..n {
        starts[i + 1] += starts[i];
    }
    let mut sides = vec![Side::default(); 3 * triangles.len()];
    let mut filled = starts.clone();
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the number of triangles is limited"
    )]
    for (triangle, corners) in triangles.iter().enumerate() {
        for (place, [from, to]) in (0_u8..).zip(pairs(corners)) {
            let end = &mut filled[from.min(to)];
            sides[*end as usize] = Side {
                other: from.max(to) as u32,
                triangle: triangle as u32,
                place: 2 * place + u8::from(from > to),
            };
            *end += 1;
        }
    }
    for range in starts.windows(2) {
        sides[range[0] as usize..range[1] as usize].sort_unstable();
    }
    (starts, sides)
}

/// Shells and the turns that make them consistent.
pub(crate) struct Orientation {
    /// Shell of each triangle.
    shell_of: Vec<usize>,
    pub(crate) shells: usize,
    /// Triangles whose corner order must be swapped.
    turned: Vec<bool>,
    /// Whether the turns agree all round.
    pub(crate) orientable: bool,
}

/// Walks over each shell and finds the turns that make neighbours agree.
fn walk(edges: &Edges) -> Orientation {
    let n = edges.beyond.len();
    let mut found = Orientation {
        shell_of: vec![usize::MAX; n],
        shells: 0,
        turned: vec![false; n],
        orientable: true,
    };
    for start in 0..n {
        if found.shell_of[start] != usize::MAX {
            continue;
        }
        found.shell_of[start] = found.shells;
        let mut to_do = vec![start];
        while let Some(triangle) = to_do.pop() {
            for (other, same) in edges.around(triangle) {
                let turn = found.turned[triangle] ^ same;
                if found.shell_of[other] == usize::MAX {
                    found.shell_of[other] = found.shells;
                    found.turned[other] = turn;
                    to_do.push(other);
                } else if found.turned[other] != turn {
                    found.orientable = false;
                }
            }
        }
        found.shells += 1;
    }
    found
}

/// Shell of each triangle.
pub(crate) fn shells_of(edges: &Edges) -> Vec<usize> {
    walk(edges).shell_of
}

/// Result of turning the triangles outward.
pub(crate) struct Turned {
    /// Triangles whose corner order was swapped.
    pub(crate) count: usize,
    /// Connected surfaces.
    pub(crate) shells: usize,
    /// Whether each shell bounds a body from outside (the others bound cavities).
    pub(crate) outer: Vec<bool>,
    /// Shell of each triangle.
    shell_of: Vec<usize>,
    /// Whether the surface has two sides.
    pub(crate) orientable: bool,
}

impl Turned {
    /// Bodies if shells count as one where a pair of triangles crosses.
    pub(crate) fn bodies_apart(&self, crossing: &[[u32; 2]]) -> usize {
        let mut above: Vec<usize> = (0..self.shells).collect();
        let root = |above: &[usize], mut shell: usize| {
            while above[shell] != shell {
                shell = above[shell];
            }
            shell
        };
        for pair in crossing {
            let [a, b] = pair.map(|triangle| root(&above, self.shell_of[triangle as usize]));
            above[a.max(b)] = a.min(b);
        }
        let outer = (0..self.shells).filter(|&shell| self.outer[shell]);
        let mut bodies: Vec<usize> = outer.map(|shell| root(&above, shell)).collect();
        bodies.sort_unstable();
        bodies.dedup();
        bodies.len()
    }
}

/// Turns all triangles so that neighbours agree and, where closed, normals point out of the body.
///
/// A shell inside an odd number of others bounds a cavity and faces inward. Shells that cut
/// each other are counted as bodies, so that a later check refuses them.
pub(crate) fn turn_outward(
    vertices: &[Vector3<f64>],
    triangles: &mut [[usize; 3]],
    edges: &Edges,
) -> Turned {
    let mut found = walk(edges);
    if !found.orientable {
        return Turned {
            count: 0,
            shells: found.shells,
            outer: vec![true; found.shells],
            shell_of: found.shell_of,
            orientable: false,
        };
    }
    let closed = edges.open.is_empty() && edges.crowded.is_empty();
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); found.shells];
    for (triangle, &shell) in found.shell_of.iter().enumerate() {
        members[shell].push(triangle);
    }
    for (triangle, &turn) in triangles.iter_mut().zip(&found.turned) {
        if turn {
            triangle.swap(1, 2);
        }
    }
    let outer = if closed {
        outer_shells(vertices, triangles, &members)
    } else {
        vec![true; found.shells]
    };
    for shell in 0..found.shells {
        let wrong = if closed {
            (volume_of(vertices, triangles, &members[shell]) > 0.0) != outer[shell]
        } else {
            let turned = members[shell].iter().filter(|&&t| found.turned[t]).count();
            2 * turned > members[shell].len()
        };
        if wrong {
            for &triangle in &members[shell] {
                triangles[triangle].swap(1, 2);
                found.turned[triangle] ^= true;
            }
        }
    }
    Turned {
        count: found.turned.iter().filter(|&&turn| turn).count(),
        shells: found.shells,
        outer,
        shell_of: found.shell_of,
        orientable: true,
    }
}

/// Which shells lie in an even number of others, or cut one.
fn outer_shells(
    vertices: &[Vector3<f64>],
    triangles: &[[usize; 3]],
    members: &[Vec<usize>],
) -> Vec<bool> {
    if members.len() == 1 || members.len() > SHELLS_TESTED {
        return vec![true; members.len()];
    }
    let corners = |t: &usize| triangles[*t].map(|i| vertices[i]);
    let solids: Vec<Solid> = members
        .iter()
        .map(|own| Solid {
            bounds: BoundingBox::of(
                own.iter()
                    .flat_map(|t| &triangles[*t])
                    .map(|i| &vertices[*i]),
            ),
            tree: OnceCell::new(),
        })
        .collect();
    let holds = |shell: usize, point: &Vector3<f64>| {
        let tree = || WindingTree::new(members[shell].iter().map(corners).collect());
        solids[shell].bounds.holds(point)
            && solids[shell]
                .tree
                .get_or_init(tree)
                .winding_number(point)
                .abs()
                > 0.5
    };
    let is_outer = |shell: usize| {
        let own = &members[shell];
        let step = own.len().div_ceil(VERTICES_TESTED);
        let points: Vec<Vector3<f64>> = own.iter().step_by(step).map(|t| corners(t)[0]).collect();
        let mut depth = 0;
        for other in (0..members.len()).filter(|&other| other != shell) {
            if !solids[other].bounds.meets(&solids[shell].bounds) {
                continue;
            }
            let inside = points.iter().filter(|point| holds(other, point)).count();
            if inside > 0 && inside < points.len() {
                return true;
            }
            depth += usize::from(inside > 0);
        }
        depth % 2 == 0
    };
    (0..members.len()).map(is_outer).collect()
}

/// What a shell encloses.
struct Solid {
    bounds: BoundingBox,
    /// Its triangles, as soon as a point in the box is asked for.
    tree: OnceCell<WindingTree>,
}

/// Enclosed volume of some triangles, positive when they face outward, m³.
fn volume_of(vertices: &[Vector3<f64>], triangles: &[[usize; 3]], members: &[usize]) -> f64 {
    let Some(&first) = members.first() else {
        return 0.0;
    };
    let origin = vertices[triangles[first][0]];
    let six_fold: f64 = members
        .iter()
        .map(|&t| {
            let [a, b, c] = triangles[t].map(|i| vertices[i] - origin);
            a.dot(&b.cross(&c))
        })
        .sum();
    six_fold / 6.0
}
