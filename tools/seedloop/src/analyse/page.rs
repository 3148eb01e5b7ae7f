//! The analysis as a page.

use std::fmt::Write as _;

use super::Report;
use super::text::{counted, fixed};
use command_line::significant;
use report::Svg;

/// The analysis as a page without scripts: its text, the rows and the charts.
pub(super) fn page(report: &Report<'_>, text: &str, charts: &[(String, Svg)]) -> String {
    let fit = report.fit;
    let escaped = |text: &str| {
        text.replace('&', "&amp;")
            .replace('<', "&lt;")
            .replace('>', "&gt;")
    };
    let response = escaped(report.response);
    let body = escaped(text);
    let mut pictures = String::new();
    for (name, chart) in charts {
        let _ = writeln!(pictures, "<h2>{}</h2>\n{}", escaped(name), chart.as_str());
    }
    let mut cases = String::new();
    for case in &fit.cases {
        let _ = writeln!(
            cases,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.4}</td><td>{}</td>\
             <td>{}</td></tr>",
            case.run,
            case.actual,
            significant(case.fitted, 6),
            significant(case.residual, 4),
            case.leverage,
            fixed(case.studentized_external, 3),
            counted(case.cooks_d, 4)
        );
    }
    let mut warnings = String::new();
    for warning in &fit.warnings {
        let _ = writeln!(warnings, "<li>{}</li>", escaped(&warning.to_string()));
    }
    let mut origin = format!("seedloop {}", escaped(&report.header.version));
    for (file, hash) in &report.header.inputs {
        let _ = write!(origin, "; {} SHA-256 {hash}", escaped(file));
    }
    format!(
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>{response}</title>\n\
         <style>body{{font-family:sans-serif}}td,th{{padding:0 .7em;text-align:right}}</style>\n\
         <h1>{response}</h1>\n<pre>{body}</pre>\n<ul>{warnings}</ul>\n<table>\n<tr><th>run</th>\
         <th>actual</th><th>fitted</th><th>residual</th><th>leverage</th>\
         <th>external studentised</th><th>Cook's D</th></tr>\n{cases}</table>\n{pictures}\
         <p>{origin}</p>\n</html>\n"
    )
}
