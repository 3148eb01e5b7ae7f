//! The loop of one study: reads the study file, runs every stage, writes the result folder.
