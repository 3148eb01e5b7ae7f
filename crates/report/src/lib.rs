//! Charts as SVG and a report as one HTML file.
