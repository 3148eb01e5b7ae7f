//! A part of a picture, read in the pixels of the whole.

use crate::refusals::binarised_arc;
use dev_support::drawn_pictures::{HeapScene, Scene};
use image::{GrayImage, Luma, imageops};
use photo_profile::{
    DrumPixels, Mode, PhotoReading, PixelPoint, PixelRegion, Settings, measure_image,
};

/// Where the part lies in the whole, px.
const CORNER: [u32; 2] = [37, 21];

/// The picture alone, and as a part of a larger grey one.
fn both(picture: &GrayImage, settings: &Settings) -> [PhotoReading; 2] {
    let (width, height) = picture.dimensions();
    let mut whole = GrayImage::from_pixel(width + 80, height + 50, Luma([90]));
    let [left, top] = CORNER;
    imageops::replace(&mut whole, picture, left.into(), top.into());
    let region = PixelRegion {
        left,
        top,
        width,
        height,
    };
    let of_part = Settings {
        region: Some(region),
        ..*settings
    };
    [(picture, settings), (&whole, &of_part)]
        .map(|(picture, settings)| measure_image(picture, settings).expect("a reading"))
}

/// All places of a reading, and all else of it.
fn places(reading: &PhotoReading) -> (Vec<PixelPoint>, String) {
    let circle = |c: DrumPixels| PixelPoint { x: c.cx, y: c.cy };
    match reading {
        PhotoReading::Drum(bed) => {
            let ends = [bed.line_ends, bed.mid_ends, bed.chord_ends].concat();
            let all = [&bed.used[..], &bed.rejected, &ends, &[circle(bed.drum)]].concat();
            (all, format!("{:?} {}", bed.angle, bed.drum.r))
        }
        PhotoReading::Heap(heap) => {
            let all = [
                &heap.used[..],
                &heap.rejected,
                &heap.lines.concat(),
                &[heap.apex],
            ]
            .concat();
            (all, format!("{} {}", heap.mean, heap.rounding))
        }
        PhotoReading::Refused(refused) => {
            let circles = [refused.drum, refused.candidate].into_iter().flatten();
            let ends = refused.line.into_iter().flatten();
            let all = refused.boundary.iter().copied().chain(ends);
            let all = all.chain(circles.map(circle)).collect();
            (all, refused.reason.to_string())
        }
    }
}

/// A bed, a heap, a bed that is refused behind its boundary, and an arc that may be a drum: every place of the part lies by
/// the corner farther in the whole, to rounding, and nothing else differs.
#[test]
fn all_places_of_a_part_move_by_its_corner() {
    let usual = Settings::default();
    let strict = Settings {
        max_angle_error: 0.1_f64.to_radians(),
        ..usual
    };
    let heap = Settings {
        mode: Mode::Heap,
        ..usual
    };
    let coarse = Scene {
        grain: [20.0, 12.0],
        ..Scene::default()
    };
    let cases = [
        (Scene::default().draw(), usual, "bed"),
        (HeapScene::default().draw(), heap, "heap"),
        (coarse.draw(), strict, "boundary"),
        (binarised_arc(15.0, 12.0), usual, "candidate"),
    ];
    for (picture, settings, kind) in &cases {
        let [alone, part] = both(picture, settings);
        let is_kind = match (&alone, *kind) {
            (PhotoReading::Drum(_), "bed") | (PhotoReading::Heap(_), "heap") => true,
            (PhotoReading::Refused(r), "boundary") => !r.boundary.is_empty() && r.line.is_some(),
            (PhotoReading::Refused(r), "candidate") => r.candidate.is_some(),
            _ => false,
        };
        assert!(is_kind, "{kind}");
        let ((alone, same), (part, other)) = (places(&alone), places(&part));
        assert_eq!(same, other, "{kind}");
        assert_eq!(alone.len(), part.len(), "{kind}");
        let [dx, dy] = CORNER.map(f64::from);
        for (a, b) in alone.iter().zip(&part) {
            let off = (b.x - a.x - dx).abs().max((b.y - a.y - dy).abs());
            assert!(off < 1e-9, "{kind}: {a:?} {b:?}");
        }
    }
}
