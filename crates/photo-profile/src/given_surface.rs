//! A surface that somebody pointed at, where the picture does not show it to the program.

use crate::drum::{FoundDrum, NotFound, find_drum};
use crate::view::{DiscView, REACH};
use crate::{
    Channel, DrumReading, Error, Foreground, Mode, PhotoPixels, PhotoReading, PixelPoint, Refusal,
    RefusedReading, Settings,
};
use nalgebra::{DMatrix, DVector};
use probability::t_two_sided_quantile;
use surface_profile::{DrumCircle, SurfaceAngle, SurfacePoint, read_surface};

/// Least number of places: a cubic through fewer leaves nothing for the error.
pub const LEAST_PLACES: usize = 5;
/// Points of the surface between places, drum radii apart.
const SPACING: f64 = 0.01;
/// Coefficients of a cubic.
const CUBIC: usize = 4;
/// Error with which somebody points at a place on a screen, px of the screen: one, our choice. Twice as much doubles the intervals
/// of surfaces that are pointed at to a pixel, and changes none of the others.
const POINTING: f64 = 1.0;
/// Longer side of a picture as somebody sees it on a screen, px; a larger one is shown smaller.
const SCREEN: f64 = 1600.0;
/// Standard errors in half of a 95 % interval.
const HALF_INTERVAL: f64 = 1.96;
/// How far a place is moved to see what it does to the angle, drum radii.
const STEP: f64 = 1e-3;

/// Measures the surface through places on it, px, in any order, in a drum that is stated or found.
///
/// Straight lines join the places; what lies beyond 0.96 of the radius is left out, as in a picture that is read. The reading gives
/// the angle and its errors, and no fill level.
///
/// # Formula
/// The places err across the surface by `s = sqrt(sum_i r_i^2 / (n - 4))`, with their residuals `r_i` from a cubic through all n. Half
/// of the 95 % interval of an angle a is `h sqrt(sum_i (da / dv_i)^2)`, with `v_i` the place i across the surface and
/// `h = max(t s, 1.96 c)`: t is the 97.5 % point of Student's distribution with n - 4 degrees of freedom, and c the error of
/// pointing, 1 px of the picture as a screen of 1600 px shows it. The standard error is that half over 1.96.
///
/// # Source
/// `[Abramowitz1964, eq. 26.7.1]` for t.
///
/// # Errors
/// As [`Settings::check`], and [`Error::BadSurface`] for fewer than five places, for one that is not finite, for a heap, and for a
/// part of the picture.
pub fn measure_given_surface(
    picture: &PhotoPixels,
    places: &[PixelPoint],
    settings: &Settings,
) -> Result<PhotoReading, Error> {
    settings.check()?;
    let bad = |what| Err(Error::BadSurface { what });
    if places.len() < LEAST_PLACES {
        return bad("five places or more are needed");
    }
    if !places.iter().all(|p| p.x.is_finite() && p.y.is_finite()) {
        return bad("each place must be two finite numbers");
    }
    if settings.mode == Mode::Heap || settings.region.is_some() {
        return bad("it is that of a drum in a whole picture");
    }
    let longer = picture.width().max(picture.height()) as f64;
    let pointing = POINTING * (longer / SCREEN).max(1.0);
    let found = match settings.drum {
        Some(circle) => Ok(FoundDrum { circle, rim: None }),
        None => find_in_any_channel(picture),
    };
    Ok(match found {
        Err(not_found) => not_found.reading(),
        Ok(drum) => {
            let view = DiscView::new(picture, drum.circle, settings.camera_roll);
            view.check()
                .and_then(|()| read(&view, &drum, (places, pointing), settings))
                .map_or_else(
                    |reason| RefusedReading::new(reason, Some(drum.circle)).into(),
                    PhotoReading::Drum,
                )
        }
    })
}

/// The drum by the luminance, or by a colour where that shows none.
fn find_in_any_channel(picture: &PhotoPixels) -> Result<FoundDrum, NotFound> {
    let by_luma = find_drum(&picture.channel(Channel::Luma));
    if by_luma.is_ok() || !picture.has_colour() {
        return by_luma;
    }
    let mut others = Channel::COLOURS.into_iter();
    others
        .find_map(|channel| find_drum(&picture.channel(channel)).ok())
        .map_or(by_luma, Ok)
}

/// Measures the surface in the disc of a drum by its places, which are known to an error of pointing (px).
fn read(
    view: &DiscView,
    drum: &FoundDrum,
    (places, pointing): (&[PixelPoint], f64),
    settings: &Settings,
) -> Result<DrumReading, Refusal> {
    let circle = DrumCircle {
        x: 0.0,
        y: 0.0,
        radius: drum.circle.r,
    };
    let points: Vec<SurfacePoint> = places.iter().map(|p| view.of_picture(p)).collect();
    let line = Line::through(&points);
    let through = |line: &Line| {
        let points = joined(&line.points(), circle.radius);
        read_surface(&points, &circle).map_err(Refusal::Surface)
    };
    let surface = through(&line)?;
    let step = STEP * circle.radius;
    let mut squares = [0.0; 3];
    // The places err independently: the squares of what each of them changes add up.
    for place in 0..places.len() {
        let moved = through(&line.with_moved(place, step))?.angle;
        let [from, to] = [surface.angle, moved].map(|a| [a.line, a.mid, a.chord]);
        for k in 0..3 {
            squares[k] += ((to[k] - from[k]) / step).powi(2);
        }
    }
    let half = half_interval(&line, circle.radius, places.len(), pointing);
    let [line_error, mid_error, chord_error] =
        squares.map(|sum| (half * sum.sqrt() / HALF_INTERVAL).hypot(settings.camera_roll_error));
    let angle = SurfaceAngle {
        standard_error: line_error,
        mid_standard_error: mid_error,
        chord_standard_error: chord_error,
        ..surface.angle
    };
    if angle.standard_error > settings.max_angle_error {
        return Err(Refusal::TooRough {
            roughness: surface.roughness / circle.radius,
            most: crate::measure::MOST_ROUGHNESS,
            error: angle.standard_error.to_degrees(),
            most_error: settings.max_angle_error.to_degrees(),
            line: angle.line.to_degrees(),
        });
    }
    let ends = |ends: [SurfacePoint; 2]| ends.map(|p| view.to_picture(&p));
    Ok(DrumReading {
        angle,
        fill_level: None,
        ends: None,
        drum: drum.circle,
        used: places.to_vec(),
        rejected: Vec::new(),
        line_ends: ends(surface.line_ends),
        mid_ends: ends(surface.mid_ends),
        chord_ends: ends(surface.chord_ends),
        foreground: Foreground::Auto,
        channel: Channel::Luma,
        quality: (surface.covered / REACH).clamp(0.0, 1.0),
    })
}

/// Half of the 95 % interval of a place across the line (px): its scatter about a cubic by Student's factor, as the four
/// coefficients are fitted to few places, or the error of pointing if that is larger.
fn half_interval(line: &Line, radius: f64, places: usize, pointing: f64) -> f64 {
    let freedom = (places - CUBIC) as f64;
    let factor = t_two_sided_quantile(0.05, freedom).unwrap_or(HALF_INTERVAL);
    (factor * line.scatter(radius)).max(HALF_INTERVAL * pointing)
}

/// Places in the frame of the direction in which they spread most.
struct Line {
    /// Cosine and sine of that direction.
    along: (f64, f64),
    /// Places along it and across it, in order, px.
    places: Vec<(f64, f64)>,
}

impl Line {
    /// The line of some places.
    fn through(points: &[SurfacePoint]) -> Self {
        let n = points.len() as f64;
        let sum = |f: &dyn Fn(&SurfacePoint) -> f64| points.iter().map(f).sum::<f64>();
        let (x, y) = (sum(&|p| p.x) / n, sum(&|p| p.y) / n);
        let xx = sum(&|p| (p.x - x).powi(2));
        let yy = sum(&|p| (p.y - y).powi(2));
        let xy = sum(&|p| (p.x - x) * (p.y - y));
        let (sin, cos) = (0.5 * f64::atan2(2.0 * xy, xx - yy)).sin_cos();
        let turned = points
            .iter()
            .map(|p| (p.x * cos + p.y * sin, p.y * cos - p.x * sin));
        let mut places: Vec<(f64, f64)> = turned.collect();
        places.sort_by(|p, q| p.0.total_cmp(&q.0));
        Self {
            along: (cos, sin),
            places,
        }
    }

    /// The places as points.
    fn points(&self) -> Vec<SurfacePoint> {
        let (cos, sin) = self.along;
        let point = |(u, v): &(f64, f64)| SurfacePoint {
            x: u * cos - v * sin,
            y: u * sin + v * cos,
        };
        self.places.iter().map(point).collect()
    }

    /// The same with one place moved across, px.
    fn with_moved(&self, place: usize, across: f64) -> Self {
        let mut places = self.places.clone();
        places[place].1 += across;
        Self { places, ..*self }
    }

    /// Standard deviation of the places across, about a cubic, px.
    fn scatter(&self, radius: f64) -> f64 {
        let n = self.places.len();
        let power = |i: usize, k: usize| {
            let part = self.places[i].0 / radius;
            [1.0, part, part * part, part.powi(3)][k]
        };
        let design = DMatrix::from_fn(n, CUBIC, power);
        let across = DVector::from_iterator(n, self.places.iter().map(|p| p.1));
        let fit = design.clone().svd(true, true).solve(&across, 1e-12);
        let rest = fit.map_or(across.norm(), |fit| (across - design * fit).norm());
        rest / ((n - CUBIC) as f64).sqrt()
    }
}

/// Points on the straight lines between corners, as far as the surface is looked at in a drum of a radius, px.
fn joined(corners: &[SurfacePoint], radius: f64) -> Vec<SurfacePoint> {
    let mut points = Vec::new();
    for pair in corners.windows(2) {
        let (dx, dy) = (pair[1].x - pair[0].x, pair[1].y - pair[0].y);
        let steps = (dx.hypot(dy) / (SPACING * radius)).ceil().max(1.0);
        let mut step = 0.0;
        while step < steps {
            let part = step / steps;
            points.push(SurfacePoint {
                x: pair[0].x + part * dx,
                y: pair[0].y + part * dy,
            });
            step += 1.0;
        }
    }
    points.extend(corners.last());
    points.retain(|p| p.x.hypot(p.y) <= REACH * radius);
    points
}

#[cfg(test)]
mod tests {
    use super::measure_given_surface;
    use crate::{DrumPixels, PhotoPixels, PixelPoint, Settings};
    use image::GrayImage;

    /// A drum in a picture that shows nothing.
    const DRUM: DrumPixels = DrumPixels {
        cx: 200.0,
        cy: 150.0,
        r: 120.0,
    };

    /// A reading of places about the axis of the drum, y up, px.
    fn reading(places: &[(f64, f64)], roll: f64) -> crate::PhotoReading {
        let blank = PhotoPixels::from_gray(&GrayImage::new(400, 300));
        let settings = Settings {
            drum: Some(DRUM),
            camera_roll: roll,
            max_angle_error: 0.5,
            ..Settings::default()
        };
        let place = |(x, y): &(f64, f64)| PixelPoint {
            x: DRUM.cx + x,
            y: DRUM.cy - y,
        };
        let places: Vec<PixelPoint> = places.iter().map(place).collect();
        measure_given_surface(&blank, &places, &settings).unwrap()
    }

    /// Places of a straight line of 30 degrees through the axis, in any order, give 30 degrees, and 25 to a camera that is turned by
    /// 5; the high side is where it rises. They scatter by nothing, and nobody points without error: 1 px at five places over 185 px
    /// turns a line by 0.36 degrees (`1 / sqrt(sum x^2)` of their places about the middle), and the line through the corners between
    /// them by somewhat more or less.
    #[test]
    fn a_straight_line_has_its_angle_and_the_error_of_pointing() {
        let slope = 30.0_f64.to_radians().tan();
        let places = [-60.0, 90.0, 0.0, -95.0, 40.0].map(|x| (x, slope * x));
        for (roll, expected) in [(0.0, 30.0), (5.0, 25.0)] {
            let angle = reading(&places, f64::to_radians(roll)).angle().unwrap();
            assert!(
                (angle.line.to_degrees() - expected).abs() < 1e-9,
                "{angle:?}"
            );
            let error = angle.standard_error.to_degrees();
            assert!((0.25..0.5).contains(&error), "{error}");
            assert_eq!(angle.high_side, surface_profile::HighSide::Right);
        }
    }

    /// Somebody points with 2 px in each direction, twice the error that is taken for granted, at 5 and at 12 places of a straight
    /// surface, and at 12 of one with an S: the 95 % interval holds the angle without error in 93 to 98 % of 400 draws. The
    /// error of that share is 1.1 %; with 5 places, one degree of freedom, it is 97 % since 1 px is the least error.
    #[test]
    fn the_interval_of_few_places_holds_the_truth() {
        let mut stream = probability::random_stream::Stream::new(3, "places of a hand");
        let slope = 30.0_f64.to_radians().tan();
        for (n, bend) in [(5, 0.0), (12, 0.0), (12, 8.0)] {
            let mut places = |noise: f64| -> Vec<(f64, f64)> {
                let part = |k: u32| 2.0 * f64::from(k) / f64::from(n - 1) - 1.0;
                let mut place = |part: f64| {
                    let across = bend * (part.powi(3) - part);
                    let [x, y] = [(); 2].map(|()| noise * stream.normal());
                    (88.0 * part + x, slope * 88.0 * part + across + y)
                };
                (0..n).map(|k| place(part(k))).collect()
            };
            let truth = reading(&places(0.0), 0.0).angle().unwrap().line;
            let held = (0..400).filter(|_| {
                let angle = reading(&places(2.0), 0.0).angle().unwrap();
                (angle.line - truth).abs() <= 1.96 * angle.standard_error
            });
            let held = held.count();
            assert!(
                (372..=392).contains(&held),
                "{held} of 400, {n} places, {bend}"
            );
        }
    }

    /// A picture of 4800 px is seen on a screen at a third of its size, and so are its places: their least error is 3 px.
    #[test]
    fn the_error_of_pointing_grows_with_the_picture() {
        let error_in = |width: u32| {
            let blank = PhotoPixels::from_gray(&GrayImage::new(width, 300));
            let settings = Settings {
                drum: Some(DRUM),
                ..Settings::default()
            };
            let places = [-90.0, -45.0, 0.0, 45.0, 90.0].map(|x| PixelPoint {
                x: DRUM.cx + x,
                y: DRUM.cy,
            });
            let reading = measure_given_surface(&blank, &places, &settings).unwrap();
            reading.angle().unwrap().standard_error
        };
        let ratio = error_in(4800) / error_in(400);
        assert!((ratio - 3.0).abs() < 1e-6, "{ratio}");
    }

    /// The order in which places of a curved surface are pointed at changes nothing but rounding.
    #[test]
    fn places_may_come_in_any_order() {
        let place = |k: i32| {
            let part = f64::from(k) / 4.0;
            (88.0 * part, 50.0 * part + 8.0 * (part.powi(3) - part))
        };
        let [along, mixed] = [
            [-4, -3, -2, -1, 0, 1, 2, 3, 4],
            [0, 3, -4, 2, -1, 4, 1, -3, -2],
        ]
        .map(|order| reading(&order.map(place), 0.0).angle().unwrap());
        assert!((along.line - mixed.line).abs() < 1e-12);
        assert!((along.standard_error - mixed.standard_error).abs() < 1e-9);
    }

    /// A drum of which more than a fifth lies outside the picture is refused, as where the surface is looked for.
    #[test]
    fn a_drum_outside_the_picture_is_refused() {
        let blank = PhotoPixels::from_gray(&GrayImage::new(300, 300));
        let settings = Settings {
            drum: Some(DrumPixels { cx: 20.0, ..DRUM }),
            ..Settings::default()
        };
        let places = [0.0, 30.0, 60.0, 90.0, 110.0].map(|x| PixelPoint { x, y: 150.0 });
        let reading = measure_given_surface(&blank, &places, &settings).unwrap();
        let reason = &reading.refused().expect("not measured").reason;
        assert!(reason.to_string().contains("given drum circle"), "{reason}");
    }

    /// Places on a short stretch tell no angle of the bed.
    #[test]
    fn a_short_stretch_is_refused() {
        let places = [0.0, 5.0, 10.0, 15.0, 20.0].map(|x| (x, 0.5 * x));
        let reading = reading(&places, 0.0);
        let reason = &reading.refused().expect("not measured").reason;
        assert!(reason.to_string().contains("surface"), "{reason}");
    }
}
