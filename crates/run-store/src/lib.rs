//! Records of finished runs under a content key, written whole or not at all.
