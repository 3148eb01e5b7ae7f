//! Reading files: orientation, cut and foreign files, size before decoding.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use dev_support::drawn_pictures::{Scene, save};
use image::{DynamicImage, ExtendedColorType, GrayImage, ImageEncoder as _, imageops};
use photo_profile::{
    Error, NoPhoto, PictureFiles, Settings, measure_image, overlay_gray, read_frames, read_photo,
    rectify,
};
use std::path::PathBuf;

/// A folder of its own for one test.
fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("photo-files-{name}"));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// A small JPEG of a drum.
fn jpeg(picture: &GrayImage) -> Vec<u8> {
    let mut bytes = Vec::new();
    image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 95)
        .write_image(
            picture,
            picture.width(),
            picture.height(),
            ExtendedColorType::L8,
        )
        .unwrap();
    bytes
}

/// Puts an EXIF segment with the orientation tag behind the start marker.
fn with_orientation(jpeg: &[u8], orientation: u8) -> Vec<u8> {
    let mut exif = b"Exif\0\0MM\0\x2A\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0".to_vec();
    exif.extend([orientation, 0, 0, 0, 0, 0, 0]);
    let length = u16::try_from(exif.len() + 2).unwrap().to_be_bytes();
    let mut bytes = jpeg[..2].to_vec();
    bytes.extend([0xFF, 0xE1, length[0], length[1]]);
    bytes.extend(exif);
    bytes.extend(&jpeg[2..]);
    bytes
}

/// A camera on its side stores the picture turned and says so (tag 6: turn clockwise to view).
/// Without the tag the surface would stand at 90 degrees less its slope. 0.1 degrees: JPEG.
#[test]
fn exif_orientation_is_honoured() {
    let upright = Scene {
        size: 400,
        radius: 180.0,
        inclination: 0.4,
        blur: 1.0,
        ..Scene::default()
    };
    let stored = imageops::rotate270(&upright.draw());
    let path = folder("exif").join("turned.jpg");
    std::fs::write(&path, with_orientation(&jpeg(&stored), 6)).unwrap();
    let angle = crate::measure_file(&path, &Settings::default())
        .unwrap()
        .angle()
        .unwrap();
    assert!(
        (angle.line - 0.4).abs() < 0.1_f64.to_radians(),
        "{} rad",
        angle.line
    );
}

/// Decoders fill a cut JPEG with grey and say nothing; PNG and BMP must fail as well.
#[test]
fn cut_files_are_errors_in_every_format() {
    let picture = Scene {
        size: 400,
        radius: 180.0,
        ..Scene::default()
    }
    .draw();
    let folder = folder("cut");
    for name in ["a.jpg", "a.png", "a.bmp"] {
        let path = folder.join(name);
        save(picture.clone(), &path).unwrap();
        assert!(read_photo(&path).is_ok(), "the whole {name} is read");
        let bytes = std::fs::read(&path).unwrap();
        std::fs::write(&path, &bytes[..bytes.len() * 2 / 3]).unwrap();
        let outcome = read_photo(&path);
        assert!(
            matches!(outcome, Err(Error::Truncated { .. } | Error::Decode { .. })),
            "{name}"
        );
    }
}

/// A header that promises 60000 by 60000 pixels is refused by its size, before any memory.
#[test]
fn a_huge_picture_is_refused_before_decoding() {
    let small = GrayImage::new(1, 1);
    let path = folder("huge").join("huge.bmp");
    save(small, &path).unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    bytes[18..22].copy_from_slice(&60_000_u32.to_le_bytes());
    bytes[22..26].copy_from_slice(&60_000_u32.to_le_bytes());
    std::fs::write(&path, bytes).unwrap();
    let outcome = read_photo(&path);
    assert!(
        matches!(
            outcome,
            Err(Error::TooLarge {
                pixels: 3_600_000_000,
                ..
            })
        ),
        "{outcome:?}"
    );
}

#[test]
fn what_is_no_picture_is_an_error() {
    let path = folder("foreign").join("text.png");
    std::fs::write(&path, "this is text").unwrap();
    assert!(
        matches!(read_photo(&path), Err(Error::Decode { .. })),
        "text is not a picture"
    );
    assert!(
        matches!(read_photo(&path.join("none")), Err(Error::Read { .. })),
        "no file"
    );
}

#[test]
fn a_still_picture_has_one_frame() {
    let path = folder("still").join("still.png");
    let still = Scene {
        size: 100,
        radius: 45.0,
        ..Scene::default()
    };
    save(still.draw(), &path).unwrap();
    assert_eq!(read_frames(&path).unwrap().count(), 1);
}

/// A drum squeezed to 0.8 of its height, straightened by the corners of its square: the slope
/// comes back to the bilinear resampling, 0.05 degrees.
#[test]
fn corners_take_the_oblique_view_out() {
    let scene = Scene {
        size: 700,
        radius: 250.0,
        aspect: 0.8,
        inclination: 0.6,
        blur: 1.0,
        ..Scene::default()
    };
    let (middle, half) = (349.5, 290.0);
    let corner = |x: f64, y: f64| photo_profile::PixelPoint {
        x: middle + x * half,
        y: middle + y * half * 0.8,
    };
    let corners = [
        corner(-1.0, -1.0),
        corner(1.0, -1.0),
        corner(1.0, 1.0),
        corner(-1.0, 1.0),
    ];
    let picture = image::DynamicImage::ImageLuma8(scene.draw());
    let straight = rectify(&picture, corners).unwrap();
    let reading = photo_profile::measure_image(&straight.to_luma8(), &Settings::default()).unwrap();
    let line = reading.angle().unwrap().line;
    assert!((line - 0.6).abs() < 0.05_f64.to_radians(), "{line} rad");
    let crossed = [corners[0], corners[2], corners[1], corners[3]];
    assert!(
        matches!(rectify(&picture, crossed), Err(Error::BadCorners)),
        "crossed corners"
    );
}

/// An animated GIF gives its frames in order, each with its own slope; 0.3 degrees: 256 colours
/// of each frame and their dither. One that would unpack to more than is decoded is an error.
#[test]
fn the_frames_of_an_animated_gif_come_in_order() {
    let slopes = [0.4, 0.6];
    let path = folder("gif").join("two.gif");
    let mut encoder = image::codecs::gif::GifEncoder::new(std::fs::File::create(&path).unwrap());
    for inclination in slopes {
        let scene = Scene {
            size: 400,
            radius: 180.0,
            inclination,
            blur: 1.0,
            ..Scene::default()
        };
        let frame = DynamicImage::ImageLuma8(scene.draw()).into_rgba8();
        encoder.encode_frame(image::Frame::new(frame)).unwrap();
    }
    drop(encoder);
    let frames: Vec<_> = read_frames(&path).unwrap().map(Result::unwrap).collect();
    assert_eq!(frames.len(), 2);
    for (frame, slope) in frames.iter().zip(slopes) {
        let picture = photo_profile::PhotoPixels::from_picture(frame);
        let reading = photo_profile::measure_photo(&picture, &Settings::default()).unwrap();
        let line = reading.angle().unwrap().line;
        assert!((line - slope).to_degrees().abs() < 0.3, "{line} rad");
    }
}

/// Corners seen in strong perspective, and ones so near to a line that the margin around the
/// square reaches the horizon: a picture or an error, never a panic.
#[test]
fn corners_in_any_perspective_give_a_picture_or_an_error() {
    let picture = DynamicImage::ImageLuma8(Scene::default().draw());
    let corner = |x: f64, y: f64| photo_profile::PixelPoint { x, y };
    for far in [250.0, 279.0, 279.9] {
        let corners = [
            corner(far, 100.0),
            corner(560.0 - far, 100.0),
            corner(500.0, 500.0),
            corner(60.0, 500.0),
        ];
        if let Ok(straight) = rectify(&picture, corners) {
            assert!(straight.width() > 0, "{far}");
        }
    }
}

/// What lies under transparent pixels is not seen: black there, the picture is measured as the one
/// on white paper, exactly.
#[test]
fn a_transparent_picture_is_read_as_on_white_paper() {
    let scene = Scene {
        size: 400,
        radius: 180.0,
        inclination: 0.5,
        outside: 255.0,
        blur: 1.0,
        ..Scene::default()
    };
    let gray = scene.draw();
    let clear = image::RgbaImage::from_fn(400, 400, |x, y| {
        let outside = (f64::from(x) - 199.5).hypot(f64::from(y) - 199.5) > 195.0;
        let value = gray.get_pixel(x, y).0[0];
        image::Rgba(if outside {
            [0, 0, 0, 0]
        } else {
            [value, value, value, 255]
        })
    });
    let folder = folder("transparent");
    let (on_white, transparent) = (folder.join("white.png"), folder.join("clear.png"));
    save(gray, &on_white).unwrap();
    save(clear, &transparent).unwrap();
    let line = |path: &PathBuf| {
        let reading = crate::measure_file(path, &Settings::default()).unwrap();
        reading.angle().unwrap().line
    };
    assert_eq!(line(&on_white), line(&transparent));
}

/// Files without a picture that systems and programs leave beside photos.
const SIDE_FILES: [&str; 6] = [
    "._a.png",
    ".DS_Store",
    "Thumbs.db",
    "desktop.ini",
    "a.png.xmp",
    "a.json",
];

/// A folder with a grey photo and one in colours, overlays of a measured and of two refused pictures without any mark but what
/// was drawn, a mask, and side files.
fn photos_among_other_files() -> PathBuf {
    let folder = folder("side-files");
    let photo = Scene {
        size: 300,
        radius: 135.0,
        ..Scene::default()
    }
    .draw();
    let blank = GrayImage::from_pixel(300, 300, image::Luma([120]));
    let settings = Settings::default();
    let strict = Settings {
        max_angle_error: 0.1_f64.to_radians(),
        ..settings
    };
    let save = |picture: DynamicImage, name: &str| {
        save(picture, folder.join(name)).expect("a picture");
    };
    save(photo.clone().into(), "a.png");
    save(
        DynamicImage::from(photo.clone()).into_rgb8().into(),
        "b.png",
    );
    save(blank.clone().into(), "mask.png");
    for (name, picture, settings) in [
        ("x-001.png", &photo, settings),
        ("x-002.png", &blank, settings),
        ("x-003.png", &photo, strict),
    ] {
        let reading = measure_image(picture, &settings).expect("a reading");
        save(overlay_gray(picture, &reading, &settings).into(), name);
    }
    for name in SIDE_FILES {
        std::fs::write(folder.join(name), "no picture").expect("a file");
    }
    folder
}

/// The two photos are read, and everything else is left out with its reason. A photo named alone is read, an overlay named
/// alone is an error.
#[test]
fn only_photos_of_a_folder_are_read() {
    let folder = photos_among_other_files();
    let find = |photos: &[PathBuf]| PictureFiles::find(photos, Some(&folder.join("mask.png")));
    let found = find(std::slice::from_ref(&folder)).unwrap();
    assert_eq!(
        found.files,
        ["a.png", "b.png"].map(|name| folder.join(name))
    );
    let count = |why| found.left_out.iter().filter(|left| left.why == why).count();
    let counts = [
        (NoPhoto::Overlay, 3),
        (NoPhoto::Mask, 1),
        (NoPhoto::Hidden, 2),
        (NoPhoto::Ending, 4),
    ];
    for (why, n) in counts {
        assert_eq!(count(why), n, "{why:?} of {:?}", found.left_out);
    }
    let remark = found.remark().unwrap();
    for part in [
        "3 overlays of this program (x-001.png",
        "4 files without the ending of a picture",
    ] {
        assert!(remark.contains(part), "{remark}");
    }
    assert_eq!(find(&[folder.join("b.png")]).unwrap().files.len(), 1);
    let alone = find(&[folder.join("x-002.png")]).unwrap_err();
    assert!(matches!(alone, Error::OnlyOverlays { .. }), "{alone}");
}
