//! The template of a run: files that are copied, and places in them that take values.

use crate::external_simulator::Error;
use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// Ending of the files that are filled in; the copy has the name without it.
const ENDING: &str = ".template";

/// The files of a folder, read once so that all runs have the same.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Template {
    /// Content and whether it may be run as a program, by the path from the folder.
    files: BTreeMap<PathBuf, (Vec<u8>, bool)>,
}

impl Template {
    /// Reads all files of a folder and of the folders in it.
    ///
    /// # Errors
    ///
    /// A file that cannot be read; a place in a template file whose name nothing has.
    pub(crate) fn read(folder: &Path, names: &[String]) -> Result<Self, Error> {
        let mut template = Self::default();
        template.read_into(folder, Path::new(""))?;
        for (path, (content, _)) in &template.files {
            let Some(text) = template_text(path, content) else {
                continue;
            };
            for name in places(text) {
                if !names.iter().any(|known| known == name) {
                    return Err(Error::Setting {
                        what: format!("{}: {{{{{name}}}}}", folder.join(path).display()),
                        problem: format!(
                            "is not a parameter, condition or effect; expected one of {}",
                            names.join(", ")
                        ),
                    });
                }
            }
        }
        Ok(template)
    }

    /// Reads the files below a folder; `inside` is its path from the top.
    fn read_into(&mut self, top: &Path, inside: &Path) -> Result<(), Error> {
        let folder = top.join(inside);
        let told = |path: &Path| {
            let path = path.to_owned();
            move |source| Error::Read {
                path: path.clone(),
                source,
            }
        };
        for entry in fs::read_dir(&folder).map_err(told(&folder))? {
            let entry = entry.map_err(told(&folder))?;
            let path = inside.join(entry.file_name());
            let file = top.join(&path);
            if file.is_dir() {
                self.read_into(top, &path)?;
            } else {
                let content = input::file::read(&file).map_err(told(&file))?;
                let runs = is_program(&file).map_err(told(&file))?;
                self.files.insert(path, (content, runs));
            }
        }
        Ok(())
    }

    /// SHA-256 of each file, in lower-case hexadecimal.
    pub(crate) fn digests(&self) -> BTreeMap<String, String> {
        let digest = |(path, (content, _)): (&PathBuf, &(Vec<u8>, bool))| {
            let mut text = String::new();
            for byte in Sha256::digest(content) {
                // Writing to a string cannot fail.
                let _ = write!(text, "{byte:02x}");
            }
            (path.display().to_string(), text)
        };
        self.files.iter().map(digest).collect()
    }

    /// Copies the files into a folder, with the values in their places.
    ///
    /// # Errors
    ///
    /// A file that cannot be written, in words.
    pub(crate) fn write(
        &self,
        folder: &Path,
        values: &BTreeMap<String, String>,
    ) -> Result<(), String> {
        for (path, (content, runs)) in &self.files {
            let (target, content) = match template_text(path, content) {
                Some(text) => (path.with_extension(""), filled(text, values).into_bytes()),
                None => (path.clone(), content.clone()),
            };
            let file = folder.join(target);
            let told = |error| format!("cannot write {}: {error}", file.display());
            if let Some(parent) = file.parent() {
                fs::create_dir_all(parent).map_err(told)?;
            }
            fs::write(&file, content).map_err(told)?;
            if *runs {
                make_program(&file).map_err(told)?;
            }
        }
        Ok(())
    }
}

/// The text of a file that is to be filled in.
fn template_text<'a>(path: &Path, content: &'a [u8]) -> Option<&'a str> {
    let name = path.file_name()?.to_str()?;
    name.ends_with(ENDING)
        .then(|| std::str::from_utf8(content).ok())?
}

/// Names of the places `{{name}}` in a text.
fn places(text: &str) -> impl Iterator<Item = &str> {
    let parts = text.split("{{").skip(1);
    parts.filter_map(|part| part.split_once("}}").map(|(name, _)| name.trim()))
}

/// A text with the values in its places.
fn filled(text: &str, values: &BTreeMap<String, String>) -> String {
    let mut parts = text.split("{{");
    let mut out = parts.next().unwrap_or("").to_owned();
    for part in parts {
        if let Some((name, rest)) = part.split_once("}}") {
            out.push_str(values.get(name.trim()).map_or("", String::as_str));
            out.push_str(rest);
        } else {
            out.push_str("{{");
            out.push_str(part);
        }
    }
    out
}

/// Whether the owner may run a file.
fn is_program(file: &Path) -> std::io::Result<bool> {
    use std::os::unix::fs::PermissionsExt as _;
    Ok(fs::metadata(file)?.permissions().mode() & 0o100 != 0)
}

/// Lets the owner run a file.
fn make_program(file: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt as _;
    fs::set_permissions(file, fs::Permissions::from_mode(0o755))
}

#[cfg(test)]
mod tests {
    use super::Template;
    use std::collections::BTreeMap;
    use std::fs;

    #[test]
    fn places_take_values_and_other_files_stay_as_they_are() {
        let (from, to) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        fs::create_dir(from.path().join("sub")).unwrap();
        let text = "mu {{ mu }} {{rpm}} {x} end";
        fs::write(from.path().join("sub/in.drum.template"), text).unwrap();
        fs::write(from.path().join("raw.sh"), text).unwrap();
        let names = ["mu", "rpm"].map(str::to_owned);
        let template = Template::read(from.path(), &names).unwrap();
        let values = BTreeMap::from([
            ("mu".to_owned(), "0.3".to_owned()),
            ("rpm".to_owned(), "10".to_owned()),
        ]);
        template.write(to.path(), &values).unwrap();
        let read = |name: &str| fs::read_to_string(to.path().join(name)).unwrap();
        assert_eq!(read("sub/in.drum"), "mu 0.3 10 {x} end");
        assert_eq!(read("raw.sh"), text);
        // One more byte is another template.
        let before = template.digests();
        fs::write(from.path().join("raw.sh"), "x").unwrap();
        let after = Template::read(from.path(), &names).unwrap().digests();
        assert_ne!(before, after);
        let error = Template::read(from.path(), &names[..1])
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("{{rpm}}") && error.contains("one of mu"),
            "{error}"
        );
    }
}
