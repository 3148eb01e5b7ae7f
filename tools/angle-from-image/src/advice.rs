//! How to continue with a picture that was refused.

use photo_profile::{DrumPixels, PhotoReading, Refusal};

/// What a user can do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Advice {
    /// The flag to paste, where one is known.
    pub(crate) flag: Option<String>,
    /// What to do, in words, the flag included.
    pub(crate) words: String,
}

impl Advice {
    /// Words without a flag.
    fn words(words: impl Into<String>) -> Self {
        Self {
            flag: None,
            words: words.into(),
        }
    }
}

/// Largest error that `--max-error-deg` takes, degrees.
const MOST_ERROR: f64 = 30.0;

/// The advice for a reading, `None` for one that was measured.
#[allow(clippy::too_many_lines, reason = "each refusal has its advice here")]
pub(crate) fn advice(reading: &PhotoReading) -> Option<Advice> {
    let refused = reading.refused()?;
    Some(match &refused.reason {
        Refusal::NoDrum { .. } => match refused.candidate {
            Some(circle) => by_circle("the dashed circle", circle, ""),
            None => Advice::words(format!("state the drum: {DRUM}")),
        },
        Refusal::BrokenRim { .. } | Refusal::TiltedView { .. } => {
            let oblique = "; a camera off the axis of the drum is put right by --corners";
            match (refused.candidate, refused.drum) {
                (Some(circle), _) => by_circle("the dashed circle", circle, oblique),
                (None, Some(circle)) => by_circle("the circle", circle, oblique),
                (None, None) => Advice::words(format!("state the drum: {DRUM}{oblique}")),
            }
        }
        Refusal::TwoDrums { first, second } => {
            let flag = |c: &DrumPixels| format!("--drum {:.1},{:.1},{:.1}", c.cx, c.cy, c.r);
            Advice {
                words: format!("state which one: {} or {}", flag(first), flag(second)),
                flag: Some(flag(first)),
            }
        }
        Refusal::TooSmall { .. } => Advice::words("give the picture in its full size"),
        Refusal::DrumOutside { .. } => Advice::words(format!(
            "state the drum in px of this picture, {DRUM}, or leave --drum out to have it found"
        )),
        Refusal::OneTone { .. } => Advice::words(format!(
            "if the eye tells bed from air, state the tone of the bed, --foreground dark or --foreground light, or \
             the drum: {DRUM}"
        )),
        Refusal::BedOnBothSides { .. } => Advice::words(format!(
            "if the overlay shows the wrong circle, state the drum: {DRUM}; a bed that is thrown round has no angle: \
             turn the drum slower"
        )),
        Refusal::Overhang { .. } => Advice::words(
            "leave this picture out and take the mean of many: the bed crumbles and stands elsewhere in the next one",
        ),
        Refusal::TooRough {
            roughness,
            most,
            error,
            ..
        } => too_rough(*roughness <= *most, *error),
        Refusal::HeapFromAbove { .. } => Advice::words(
            "take the picture from the side, with the camera as high as the foot of the heap: from there its flanks show",
        ),
        Refusal::HeapUncertain { error, .. } => {
            let flag = error_flag(*error);
            let by = flag
                .as_ref()
                .map_or_else(String::new, |flag| format!(" with {flag}"));
            Advice {
                words: format!(
                    "if flanks differ by the camera, state its roll (--camera-roll-deg, --level); else allow for the error{by}, \
                     and take the mean of many pictures"
                ),
                flag,
            }
        }
        Refusal::HeapCut => Advice::words("take the picture with air above the heap"),
        Refusal::Surface(surface_profile::Error::NoHeap { .. }) => Advice::words(
            "take the heap from the side, on its base, before a plain background; for a drum leave --mode heap out",
        ),
        _ => Advice::words(format!(
            "if the overlay shows a wrong circle or boundary, state the drum, {DRUM}, or the tone of the bed, \
             --foreground dark or --foreground light, or point at the surface in the page of --html, which gives --surface"
        )),
    })
}

/// How a drum is stated.
const DRUM: &str = "--drum CX,CY,R (px, y down from the upper left)";

/// A circle that may be the drum.
fn by_circle(which: &str, circle: DrumPixels, more: &str) -> Advice {
    let DrumPixels { cx, cy, r } = circle;
    let flag = format!("--drum {cx:.1},{cy:.1},{r:.1}");
    Advice {
        words: format!(
            "if {which} of the overlay is the drum, continue with {flag}, else state the drum: {DRUM}{more}"
        ),
        flag: Some(flag),
    }
}

/// A surface whose error (degrees) is too large, its roughness allowed or not.
fn too_rough(roughness_is_allowed: bool, error: f64) -> Advice {
    let Some(flag) = error_flag(error).filter(|_| roughness_is_allowed) else {
        return Advice::words("the grains are too coarse for this drum: take a larger one");
    };
    Advice {
        words: format!("allow for the error with {flag}, and take the mean of many pictures"),
        flag: Some(flag),
    }
}

/// The flag that allows an error (degrees), rounded up to a tenth; none if that exceeds what the flag takes.
fn error_flag(error: f64) -> Option<String> {
    let allowed = (10.0 * error).ceil() / 10.0;
    (allowed <= MOST_ERROR).then(|| format!("--max-error-deg {allowed:.1}"))
}
