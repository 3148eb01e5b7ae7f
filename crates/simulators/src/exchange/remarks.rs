//! What a reader of an export must know, written into the export itself: files are passed on without the screen on which they were made.

use crate::exchange::vtk::File;
use std::path::Path;

/// Name of the file that says it where a format has no comments.
const BESIDE: &str = "WARNING.txt";

/// Writes warnings into an export: as comments at the head of its script or list, as rows at the end of the table for EDEM, and in
/// `WARNING.txt` beside tables of frames, which have no comments.
pub fn add_warnings(files: &mut Vec<File>, warnings: &[String]) {
    if warnings.is_empty() {
        return;
    }
    let lines = |before: &str, after: &str| -> String {
        let line = |warning: &String| format!("{before}WARNING: {}{after}\n", plain(warning));
        warnings.iter().map(line).collect()
    };
    let Some(first) = files.first_mut() else {
        return;
    };
    if first.name.starts_with("in.") {
        first.text.insert_str(0, &lines("# ", ""));
    } else if Path::new(&first.name)
        .extension()
        .is_some_and(|end| end == "pvd")
    {
        // The declaration of XML comes first.
        let begin = first.text.find('\n').map_or(0, |end| end + 1);
        first.text.insert_str(begin, &lines("<!-- ", " -->"));
    } else if first.name == "edem.csv" {
        first.text.push_str(&lines("\"", "\",,,,,"));
    } else {
        files.push(File {
            name: BESIDE.to_owned(),
            text: lines("", ""),
        });
    }
}

/// A text as one line that ends no comment and no cell and does not continue on the next line: names of users may contain anything.
fn plain(text: &str) -> String {
    let harmless = |c: char| if c.is_control() { ' ' } else { c };
    let mut text: String = text.chars().map(harmless).collect();
    // Of three hyphens one replacement leaves two.
    while text.contains("--") {
        text = text.replace("--", "- -");
    }
    text.replace('"', "'").replace('&', "and")
}

#[cfg(test)]
mod tests {
    use super::add_warnings;
    use crate::exchange::vtk::File;

    /// The file of a name after a warning that tries to leave its comment.
    fn warned(name: &str, text: &str) -> Vec<File> {
        let mut files = vec![File {
            name: name.into(),
            text: text.into(),
        }];
        add_warnings(&mut files, &["NOT MET: a \"b\" --->\nrun 5 &".to_owned()]);
        files
    }

    #[test]
    fn every_format_carries_a_warning_that_stays_a_comment() {
        let said = "WARNING: NOT MET: a 'b' - - -> run 5 and";
        assert_eq!(
            warned("in.drum", "units si\n")[0].text,
            format!("# {said}\nunits si\n")
        );
        let list = &warned("frames.pvd", "<?xml?>\n<VTKFile>\n")[0].text;
        assert_eq!(*list, format!("<?xml?>\n<!-- {said} -->\n<VTKFile>\n"));
        let table = &warned("edem.csv", "where,of,setting,unit,value,how\n")[0].text;
        assert_eq!(
            *table,
            format!("where,of,setting,unit,value,how\n\"{said}\",,,,,\n")
        );
        let files = warned("frames_0000.csv", "x_m\n");
        assert_eq!((&*files[0].text, &*files[1].name), ("x_m\n", "WARNING.txt"));
        assert_eq!(files[1].text, format!("{said}\n"));
    }
}
