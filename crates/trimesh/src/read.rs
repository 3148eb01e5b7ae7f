//! Reading a mesh of any known format.

use crate::obj::{looks_like_obj, obj_soup};
use crate::ply::{looks_like_ply, ply_soup};
use crate::soup::{Soup, bytes_of};
use crate::stl::stl_soup;
use crate::{CheckedMesh, Error, LengthUnit, Repair};
use std::path::Path;

/// Reads and checks a mesh file (STL, OBJ or PLY) whose numbers are in `unit`.
///
/// What a file holds decides its format; its name decides only between an OBJ and an STL that
/// both cannot be told from their text.
///
/// # Errors
///
/// The file cannot be read, is not a whole mesh file, or holds no body; see [`Error`].
pub fn read_mesh(path: &Path, unit: LengthUnit) -> Result<CheckedMesh, Error> {
    read_mesh_with(path, unit, &Repair::default())
}

/// Reads and checks a mesh file as [`read_mesh`] does, with other repairs than the default ones.
///
/// # Errors
///
/// As of [`read_mesh`].
pub fn read_mesh_with(
    path: &Path,
    unit: LengthUnit,
    repair: &Repair,
) -> Result<CheckedMesh, Error> {
    let (name, bytes) = bytes_of(path)?;
    let soup = soup_of(&bytes, &name)?;
    drop(bytes);
    soup.check(unit, &name, repair)
}

/// Reads and checks the bytes of a mesh file; `file` names it in messages.
///
/// # Errors
///
/// The bytes are not a whole mesh file or hold no body; see [`Error`].
pub fn parse_mesh(bytes: Vec<u8>, unit: LengthUnit, file: &str) -> Result<CheckedMesh, Error> {
    let soup = soup_of(&bytes, file)?;
    drop(bytes);
    soup.check(unit, file, &Repair::default())
}

/// Loose triangles of the bytes of a mesh file.
fn soup_of(bytes: &[u8], file: &str) -> Result<Soup, Error> {
    let is_obj = || {
        let named = Path::new(file)
            .extension()
            .is_some_and(|end| end.eq_ignore_ascii_case("obj"));
        named || looks_like_obj(bytes)
    };
    if looks_like_ply(bytes) {
        return ply_soup(bytes, file);
    }
    match stl_soup(bytes, file) {
        Err(Error::NotMesh { .. }) if is_obj() => obj_soup(bytes, file),
        other => other,
    }
}
