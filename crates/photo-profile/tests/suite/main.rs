//! The reader of pictures on drawn and real pictures.
//!
//! One program for all files: it is linked once, and its tests share the cores.

mod colours;
mod files;
mod heaps;
mod kinds;
mod mutated_files;
mod other_library;
mod real_photos;
mod refusals;
mod regions;
mod synthetic_pictures;
