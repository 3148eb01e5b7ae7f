//! The workspace agrees with its documents: arrows with the map, citations with the sources, files
//! with the rules of the tree, texts with the words of the project.

#[path = "architecture/arrows.rs"]
mod arrows;
#[path = "architecture/citations.rs"]
mod citations;
#[path = "architecture/language.rs"]
mod language;
#[path = "architecture/materials.rs"]
mod materials;
#[path = "architecture/tree.rs"]
mod tree;
