//! Whether a JPEG file reaches its end marker; decoders fill a cut picture with grey silently.

/// Whether the markers of a JPEG lead to the end-of-image marker.
///
/// Segments are skipped by their length, so a preview inside the metadata cannot stand for the
/// end of the picture; bytes after the end marker are fine (`[T81, annex B]`).
pub(crate) fn reaches_end(bytes: &[u8]) -> bool {
    let mut at = 2;
    loop {
        // Between segments and in the coded data alike: on to the next marker.
        let Some(step) = bytes
            .get(at..)
            .and_then(|rest| rest.iter().position(|b| *b == 0xFF))
        else {
            return false;
        };
        at += step + 1;
        let Some(&marker) = bytes.get(at) else {
            return false;
        };
        match marker {
            0xD9 => return true,
            // Stuffed byte, fill byte, stand-alone markers (TEM, restart, start): no length.
            0xFF => {}
            0x00 | 0x01 | 0xD0..=0xD8 => at += 1,
            _ => {
                let (Some(&high), Some(&low)) = (bytes.get(at + 1), bytes.get(at + 2)) else {
                    return false;
                };
                at += 1 + usize::from(u16::from_be_bytes([high, low])).max(2);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::reaches_end;

    /// A comment segment of 6 bytes that holds an end marker, coded data with a stuffed byte.
    const WHOLE: [u8; 16] = [
        0xFF, 0xD8, 0xFF, 0xFE, 0, 6, 0xFF, 0xD9, 1, 2, 0x11, 0xFF, 0x00, 0x22, 0xFF, 0xD9,
    ];

    #[test]
    fn the_end_marker_is_found_and_no_cut_file_has_one() {
        assert!(reaches_end(&WHOLE), "the whole file has its end");
        for n in 0..WHOLE.len() {
            assert!(!reaches_end(&WHOLE[..n]), "cut after {n} bytes");
        }
    }
}
