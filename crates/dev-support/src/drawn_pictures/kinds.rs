//! Kinds of drawn pictures, each with its spread of shapes, lights and troubles.

use crate::drawn_pictures::camera::to_level;
use crate::drawn_pictures::{Disturbance, Scene};
use image::codecs::jpeg::{JpegDecoder, JpegEncoder};
use image::{DynamicImage, GrayImage, ImageEncoder as _, Luma};
use probability::random_stream::Stream;
use std::f64::consts::PI;
use std::io::Cursor;

/// Expected result for a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Class {
    /// A surface that a person reads without doubt.
    Clean,
    /// A valid surface with troubles.
    Hard,
    /// No valid surface.
    Hopeless,
}

/// A kind of picture.
#[derive(Debug, Clone, Copy)]
pub struct Kind {
    /// Its name.
    pub name: &'static str,
    /// Expected result.
    pub class: Class,
    /// Draws the scene of a stream.
    scene: fn(&mut Stream) -> Scene,
    /// What else is done to the picture.
    finish: Finish,
}

/// What is done to the drawn picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Finish {
    /// Nothing.
    None,
    /// Stored as a JPEG of quality 40 to 90.
    Jpeg,
    /// Replaced by grey noise.
    Noise,
    /// Bed thrown outwards: a ring along the wall, as in a centrifuge.
    Ring,
    /// The upper half of the bed's end broken away: a cliff in the middle of the surface.
    Cliff,
}

/// A drawn picture and what is true of it.
#[derive(Debug, Clone)]
pub struct Trial {
    /// The picture.
    pub picture: GrayImage,
    /// Its scene; for a hopeless one the surface means nothing.
    pub scene: Scene,
}

impl Kind {
    /// The picture of a number.
    pub fn trial(&self, number: u64) -> Trial {
        let mut random = Stream::new(number, self.name);
        let mut scene = (self.scene)(&mut random);
        scene.seed = number.wrapping_add(1);
        let drawn = scene.draw();
        let picture = match self.finish {
            Finish::None => drawn,
            Finish::Jpeg => jpeg(drawn, random.between(40.0, 90.0)),
            Finish::Noise => GrayImage::from_fn(drawn.width(), drawn.height(), |_, _| {
                Luma([to_level(random.between(0.0, 255.0))])
            }),
            Finish::Ring => redrawn(&drawn, &scene, |x, y| x.hypot(y) > 0.75),
            Finish::Cliff => redrawn(&drawn, &scene, |x, y| {
                y < if x < 0.05 { 0.45 } else { -0.45 }
            }),
        };
        Trial { picture, scene }
    }
}

/// Draws the inside of the drum again: bed where the function of (x, y) in drum radii, y up, says.
fn redrawn(drawn: &GrayImage, scene: &Scene, is_bed: impl Fn(f64, f64) -> bool) -> GrayImage {
    let [cx, cy] = scene.centre();
    let mut picture = drawn.clone();
    for (x, y, pixel) in picture.enumerate_pixels_mut() {
        let (x, y) = (
            (f64::from(x) - cx) / scene.radius,
            (cy - f64::from(y)) / scene.radius,
        );
        if x.hypot(y) < 0.99 {
            let tone = if is_bed(x, y) { scene.bed } else { scene.air };
            *pixel = Luma([to_level(tone)]);
        }
    }
    picture
}

/// The picture as a JPEG file gives it back.
fn jpeg(picture: GrayImage, quality: f64) -> GrayImage {
    let mut bytes = Vec::new();
    let quality = to_level(quality);
    let (width, height) = picture.dimensions();
    let written = JpegEncoder::new_with_quality(&mut bytes, quality).write_image(
        &picture,
        width,
        height,
        image::ExtendedColorType::L8,
    );
    written
        .and_then(|()| JpegDecoder::new(Cursor::new(&bytes)))
        .and_then(DynamicImage::from_decoder)
        .map_or(picture, DynamicImage::into_luma8)
}

/// A straight powder surface in a lit drum: size, place, slope, fill, tones, blur and noise vary.
fn plain(r: &mut Stream) -> Scene {
    let size = r.between(320.0, 900.0);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "320 to 900"
    )]
    let side = size as u32;
    let radius = size * r.between(0.3, 0.45);
    let room = 0.48 * size - radius;
    let dark = r.uniform() < 0.5;
    let (low, high) = (r.between(20.0, 80.0), r.between(150.0, 230.0));
    let left = if r.uniform() < 0.5 { -1.0 } else { 1.0 };
    Scene {
        size: side,
        radius,
        shift: [r.between(-1.0, 1.0) * room, r.between(-1.0, 1.0) * room],
        inclination: left * r.between(15.0, 60.0) * PI / 180.0,
        height: r.between(-0.4, 0.4),
        bed: if dark { low } else { high },
        air: if dark { high } else { low },
        outside: r.between(5.0, 250.0),
        rim: r.between(5.0, 250.0),
        rim_width: r.between(1.0, 0.06 * radius),
        blur: r.between(0.6, 1.6),
        noise: r.between(1.0, 6.0),
        ..Scene::default()
    }
}

/// A plain scene with a trouble.
fn troubled(r: &mut Stream, trouble: fn(&mut Stream) -> Disturbance) -> Scene {
    let scene = plain(r);
    Scene {
        disturbance: trouble(r),
        ..scene
    }
}

/// Semi-axes of grains between two parts of the drum radius.
fn grains(r: &mut Stream, radius: f64, least: f64, most: f64) -> [f64; 2] {
    let long = radius * r.between(least, most);
    [long, long * r.between(0.5, 1.0)]
}

/// All kinds: clean ones, hard ones, hopeless ones.
pub fn kinds() -> Vec<Kind> {
    [clean(), hard(), harder(), hopeless()].concat()
}

/// A kind without further treatment.
fn kind(name: &'static str, class: Class, scene: fn(&mut Stream) -> Scene) -> Kind {
    Kind {
        name,
        class,
        scene,
        finish: Finish::None,
    }
}

/// Surfaces without trouble.
fn clean() -> Vec<Kind> {
    vec![
        kind("straight powder", Class::Clean, plain),
        kind("curved or S-shaped", Class::Clean, |r| Scene {
            curvature: r.between(-0.12, 0.12),
            s_shape: r.between(-0.05, 0.25),
            ..plain(r)
        }),
        kind("time average, grey ramp", Class::Clean, |r| Scene {
            ramp: r.between(8.0, 45.0),
            s_shape: r.between(0.0, 0.15),
            ..plain(r)
        }),
        kind("no visible rim", Class::Clean, |r| {
            let scene = plain(r);
            Scene {
                outside: scene.air,
                rim: scene.air,
                ..scene
            }
        }),
        kind("low contrast", Class::Clean, |r| {
            let scene = plain(r);
            let contrast = r.between(20.0, 40.0) * if scene.bed < scene.air { 1.0 } else { -1.0 };
            Scene {
                bed: scene.air - contrast,
                noise: r.between(1.0, 3.0),
                ..scene
            }
        }),
        kind("fine grains", Class::Clean, |r| {
            let scene = plain(r);
            Scene {
                grain: grains(r, scene.radius, 0.01, 0.02),
                ..scene
            }
        }),
    ]
}

/// Valid surfaces with troubles.
fn hard() -> Vec<Kind> {
    vec![
        kind("coarse grains", Class::Hard, |r| {
            let scene = plain(r);
            Scene {
                grain: grains(r, scene.radius, 0.03, 0.07),
                ..scene
            }
        }),
        kind("uneven light", Class::Hard, |r| {
            troubled(r, |r| Disturbance {
                vignette: r.between(0.1, 0.6),
                light: [r.between(-0.6, 0.6), r.between(-0.6, 0.6)],
                ..Disturbance::NONE
            })
        }),
        kind("reflections", Class::Hard, |r| {
            troubled(r, |r| Disturbance {
                n_reflections: 2,
                reflection: r.between(30.0, 130.0),
                ..Disturbance::NONE
            })
        }),
        kind("bolts and clutter", Class::Hard, |r| {
            troubled(r, |r| Disturbance {
                n_bolts: if r.uniform() < 0.5 { 6 } else { 8 },
                n_clutter: 8,
                ..Disturbance::NONE
            })
        }),
        kind("rim partly hidden", Class::Hard, |r| {
            troubled(r, |r| Disturbance {
                hidden: r.between(0.05, 0.25),
                ..Disturbance::NONE
            })
        }),
        kind("halo and shadow", Class::Hard, |r| {
            troubled(r, |r| Disturbance {
                halo: r.between(-40.0, 40.0),
                shadow: r.between(0.1, 0.7),
                ..Disturbance::NONE
            })
        }),
        kind("stuck particles and dust", Class::Hard, |r| Scene {
            n_dust: 100,
            ..troubled(r, |_| Disturbance {
                n_stuck: 30,
                ..Disturbance::NONE
            })
        }),
        kind("curl at the wall", Class::Hard, |r| {
            troubled(r, |r| Disturbance {
                curl: r.between(0.05, 0.4),
                ..Disturbance::NONE
            })
        }),
    ]
}

/// More valid surfaces with troubles.
fn harder() -> Vec<Kind> {
    vec![
        kind("axle hub", Class::Hard, |r| {
            troubled(r, |r| Disturbance {
                hub: r.between(0.05, 0.15),
                ..Disturbance::NONE
            })
        }),
        kind("back-wall edge", Class::Hard, |r| {
            troubled(r, |r| Disturbance {
                back_edge: r.between(0.02, 0.1),
                ..Disturbance::NONE
            })
        }),
        kind("blotchy tones", Class::Hard, |r| {
            troubled(r, |r| Disturbance {
                blotches: r.between(5.0, 20.0),
                ..Disturbance::NONE
            })
        }),
        kind("strong noise", Class::Hard, |r| Scene {
            noise: r.between(20.0, 45.0),
            ..plain(r)
        }),
        kind("strong blur", Class::Hard, |r| Scene {
            blur: r.between(3.0, 8.0),
            ..plain(r)
        }),
        kind("little or much bed", Class::Hard, |r| {
            let height = r.between(0.5, 0.75) * if r.uniform() < 0.5 { -1.0 } else { 1.0 };
            Scene { height, ..plain(r) }
        }),
        kind("camera slightly tilted", Class::Hard, |r| Scene {
            aspect: r.between(0.978, 1.0),
            ..plain(r)
        }),
        Kind {
            name: "many troubles, JPEG",
            class: Class::Hard,
            scene: many_troubles,
            finish: Finish::Jpeg,
        },
    ]
}

/// A scene with a little of most troubles at once.
fn many_troubles(r: &mut Stream) -> Scene {
    let scene = troubled(r, |r| Disturbance {
        vignette: r.between(0.0, 0.3),
        light: [r.between(-0.3, 0.3), r.between(-0.3, 0.3)],
        n_reflections: 1,
        reflection: r.between(20.0, 80.0),
        n_bolts: 6,
        hidden: r.between(0.0, 0.1),
        shadow: r.between(0.0, 0.3),
        n_stuck: 8,
        curl: r.between(0.0, 0.15),
        n_clutter: 5,
        blotches: r.between(0.0, 8.0),
        ..Disturbance::NONE
    });
    Scene {
        grain: grains(r, scene.radius, 0.01, 0.04),
        n_dust: 30,
        ..scene
    }
}

/// Pictures that must not give a number.
fn hopeless() -> Vec<Kind> {
    let with = |name, finish, scene: fn(&mut Stream) -> Scene| Kind {
        name,
        class: Class::Hopeless,
        scene,
        finish,
    };
    vec![
        kind("empty drum", Class::Hopeless, |r| Scene {
            height: -1.5,
            ..plain(r)
        }),
        kind("full drum", Class::Hopeless, |r| {
            let scene = plain(r);
            Scene {
                height: 1.5,
                grain: grains(r, scene.radius, 0.01, 0.07),
                ..scene
            }
        }),
        kind("empty drum in uneven light", Class::Hopeless, |r| Scene {
            height: -1.5,
            ..troubled(r, |r| Disturbance {
                vignette: r.between(0.0, 0.6),
                light: [r.between(-1.0, 1.0), r.between(-1.0, 1.0)],
                n_reflections: 2,
                reflection: r.between(30.0, 130.0),
                blotches: r.between(0.0, 10.0),
                ..Disturbance::NONE
            })
        }),
        with("noise", Finish::Noise, plain),
        kind("clutter without a drum", Class::Hopeless, |r| {
            let scene = plain(r);
            Scene {
                radius: 4.0,
                rim_width: 0.5,
                disturbance: Disturbance {
                    n_clutter: 15,
                    ..Disturbance::NONE
                },
                ..scene
            }
        }),
        kind("tilted camera", Class::Hopeless, |r| Scene {
            aspect: r.between(0.6, 0.95),
            ..plain(r)
        }),
        with("centrifuged ring", Finish::Ring, plain),
        with("crumbled cliff", Finish::Cliff, plain),
    ]
}

#[cfg(test)]
mod tests {
    use super::jpeg;
    use crate::drawn_pictures::Scene;
    use image::GrayImage;

    /// Quality 100 divides by steps of one level, which leaves less than one of 255 levels in the mean square; quality 5 by steps
    /// of 100 and more, which an edge of bed and air shows with several levels.
    #[test]
    fn a_jpeg_loses_more_at_a_lower_quality() {
        let picture = Scene::default().draw();
        let loss = |quality: f64| {
            let back: GrayImage = jpeg(picture.clone(), quality);
            assert_eq!(back.dimensions(), picture.dimensions());
            let pairs = back.iter().zip(picture.iter());
            let squares = pairs.map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2));
            (squares.sum::<f64>() / picture.len() as f64).sqrt()
        };
        let (little, much) = (loss(100.0), loss(5.0));
        assert!(little < 1.0 && much > 2.0, "{little} and {much} levels");
    }
}
