//! PLY (Stanford polygon format): ASCII and binary of both byte orders.
//!
//! Read are `x`, `y`, `z` of the element `vertex` and the list `vertex_indices` (or
//! `vertex_index`) of the element `face`; all else is passed over. No memory is set aside for a
//! declared count: a count beyond the data ends at the end of the file.

mod data;
mod header;

use crate::Error;
use crate::polygon::vertex;
use crate::soup::Soup;
use data::Data;
use header::{Element, Header, Kind};
use nalgebra::Vector3;

/// Whether a file begins as a PLY.
pub(crate) fn looks_like_ply(bytes: &[u8]) -> bool {
    let text = crate::words::without_mark(bytes);
    text.starts_with(b"ply\n") || text.starts_with(b"ply\r") || text.starts_with(b"ply ")
}

/// Reads the polygons.
pub(crate) fn ply_soup(bytes: &[u8], file: &str) -> Result<Soup, Error> {
    let (header, body, line) = Header::read(bytes, file)?;
    let mut data = Data::new(body, header.encoding, line, file);
    let mut vertices = Vec::new();
    let mut soup = Soup::default();
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => read_vertices(element, &mut data, &mut vertices)?,
            "face" => read_faces(element, &mut data, &vertices, &mut soup)?,
            _ => {
                for _ in 0..element.rows() {
                    read_row(element, &mut data, |_, _| {})?;
                }
            }
        }
    }
    soup.or_points(vertices.len(), file)
}

/// Reads one row; `take` gets each value with the index of its property.
fn read_row(
    element: &Element,
    data: &mut Data<'_>,
    mut take: impl FnMut(usize, f64),
) -> Result<(), Error> {
    for (index, property) in element.properties.iter().enumerate() {
        match property.kind {
            Kind::One(scalar) => take(index, data.number(scalar)?),
            Kind::List { count, item } => {
                let n = data.count(count)?;
                for _ in 0..n {
                    take(index, data.number(item)?);
                }
            }
        }
    }
    Ok(())
}

fn read_vertices(
    element: &Element,
    data: &mut Data<'_>,
    vertices: &mut Vec<Vector3<f64>>,
) -> Result<(), Error> {
    let mut places = [0; 3];
    for (place, name) in places.iter_mut().zip(["x", "y", "z"]) {
        let found = element.properties.iter().position(|p| p.name == name);
        *place = found.ok_or_else(|| data.fault("the properties x, y, z of a vertex"))?;
    }
    for _ in 0..element.rows() {
        let mut point = Vector3::repeat(f64::NAN);
        read_row(element, data, |index, value| {
            if let Some(k) = places.iter().position(|&place| place == index) {
                point[k] = value;
            }
        })?;
        if !point.iter().all(|value| value.is_finite()) {
            return Err(data.fault("finite coordinates"));
        }
        vertices.push(point);
    }
    Ok(())
}

fn read_faces(
    element: &Element,
    data: &mut Data<'_>,
    vertices: &[Vector3<f64>],
    soup: &mut Soup,
) -> Result<(), Error> {
    let names = ["vertex_indices", "vertex_index"];
    let is_corners = |name: &str| names.contains(&name);
    let list = element.properties.iter().position(|p| is_corners(&p.name));
    let list = list.ok_or_else(|| data.fault("the list vertex_indices of a face"))?;
    let mut indices = Vec::new();
    let mut corners = Vec::new();
    for _ in 0..element.rows() {
        indices.clear();
        corners.clear();
        read_row(element, data, |index, value| {
            if index == list {
                indices.push(value);
            }
        })?;
        for &value in &indices {
            let fault = || data.fault("the index of a vertex that was given before");
            corners.push(vertex(vertices, whole(value), fault)?);
        }
        if corners.len() < 3 {
            return Err(data.fault("three or more vertices of a face"));
        }
        soup.push_polygon(&corners);
    }
    Ok(())
}

/// A value as an index.
fn whole(value: f64) -> Option<usize> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "checked to be a whole number of 32 bits"
    )]
    (value >= 0.0 && value <= f64::from(u32::MAX) && value.fract() == 0.0).then_some(value as usize)
}
