"""Draws drums and heaps of single grains, and things that are neither, and gives them to angle-from-image.

Usage: python3 pictures.py PICTURES_A_KIND [OTHER_ANGLE_FROM_IMAGE ...], with the packages numpy and pillow

Needs NumPy and Pillow. Each grain is a shaded disc whose centre lies under a known curve, so that the edge of the
bed is as rough as its grains are large. A refused drum is given again with the circle that it was drawn with
(`--drum`), as a user would who points at the rim. Output is a Markdown table, one row a kind and program: how many
were read at once, with the circle, never; the root mean square and the largest error of `line` (of heaps the
mean of both flanks) in degrees; and how many of the stated 95 % intervals hold the truth. Kinds without an angle
have no truth: there each picture read is a wrong one. The pictures are the same each time. The variable KIND
picks the kinds with that word in their name.
"""

import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

import runs

import numpy
from PIL import Image, ImageDraw, ImageFilter

SIZE = 640


def surface(x, slope, bend, toe):
    """Height of the surface at x, in radii of the drum: a line, an S of cubic form, a toe that turns up on the left."""
    return math.tan(slope) * x + bend * (x**3 - 0.4 * x) + toe * max(0.0, -x - 0.3) ** 2


def line_of(xs, ys):
    """Principal axis of a curve averaged over hundredths of its way along that axis, degrees."""
    angle = math.atan(numpy.polyfit(xs, ys, 1)[0])
    for _ in range(10):
        along = xs * math.cos(angle) + ys * math.sin(angle)
        place = numpy.floor(100 * (along - along.min()) / (numpy.ptp(along) + 1e-9)).astype(int)
        count = numpy.bincount(place)
        x, y = (numpy.bincount(place, v)[count > 0] / count[count > 0] for v in (xs, ys))
        (xx, xy), (_, yy) = numpy.cov(x, y)
        angle = 0.5 * math.atan2(2 * xy, xx - yy)
    return math.degrees(angle)


def drum(rng, grain=0.02, bend=0.0, toe=0.0, slope=None, fill=None, bed=((170, 60), (130, 60), (80, 60)),
         air=(215, 215, 215), rim=(40, 40, 40), outside=(120, 120, 120), blur=0.8, noise=4.0, radius=None, binary=False):
    """A drum of grains: picture, circle, truth in degrees.

    `bed` holds mean and spread of the tones of the grains in red, green, blue; `grain` is a radius in radii of the drum.
    """
    slope = slope if slope is not None else math.radians(rng.uniform(22, 48))
    offset = fill if fill is not None else rng.uniform(-0.3, 0.1)
    big = 2
    radius = radius or rng.uniform(0.36, 0.44) * SIZE
    cx, cy = SIZE / 2 + rng.uniform(-20, 20), SIZE / 2 + rng.uniform(-20, 20)
    image = Image.new("RGB", (big * SIZE, big * SIZE), outside)
    draw = ImageDraw.Draw(image)
    circle = lambda r, tone: draw.ellipse([big * (cx - r), big * (cy - r), big * (cx + r), big * (cy + r)], fill=tone)
    if rim is not None:
        circle(1.06 * radius, rim)
    circle(radius, air)
    height = lambda x: surface(x, slope, bend, toe) + offset
    step = 1.7 * grain
    inside = Image.new("RGB", image.size, air)
    pen = ImageDraw.Draw(inside)
    mean = tuple(int(0.75 * tone) for tone, _ in bed)
    # The ground between the grains, a little below the surface.
    ground = [(x, height(x) - 0.8 * grain) for x in numpy.linspace(-1.1, 1.1, 200)]
    place = lambda x, y: (big * (cx + radius * x), big * (cy - radius * y))
    pen.polygon([place(x, y) for x, y in ground] + [place(1.1, -1.3), place(-1.1, -1.3)], fill=mean)
    for y in numpy.arange(-1.1, 1.1, step * 0.87):
        for x in numpy.arange(-1.1, 1.1, step):
            px, py = x + rng.normal(0, 0.25 * grain), y + rng.normal(0, 0.25 * grain)
            if py + grain > height(px):
                continue
            shade = rng.normal(0, 1)
            tone = tuple(int(numpy.clip(t + 0.3 * s * shade, 0, 255)) for t, s in bed)
            r = grain * rng.uniform(0.85, 1.05)
            (u, v), w = place(px, py), big * radius * r
            pen.ellipse([u - w, v - w, u + w, v + w], fill=tone)
    mask = Image.new("L", image.size, 0)
    ImageDraw.Draw(mask).ellipse([*place(-1, 1), *place(1, -1)], fill=255)
    image.paste(inside, (0, 0), mask)
    image = finish(image, rng, blur, noise, binary)
    xs = numpy.linspace(-1, 1, 4001)
    ys = numpy.array([height(x) for x in xs])
    within = xs**2 + ys**2 < 1
    truth = line_of(xs[within], ys[within]) if within.any() else None
    return image, (cx, cy, radius), truth


def finish(image, rng, blur, noise, binary=False):
    """Halved, blurred, with noise, or of two tones."""
    image = image.resize((image.width // 2, image.height // 2), Image.Resampling.BOX)
    image = image.filter(ImageFilter.GaussianBlur(blur))
    pixels = numpy.asarray(image, dtype=float)
    if binary:
        pixels = numpy.where(pixels.mean(axis=2, keepdims=True) > 150, 255.0, 0.0).repeat(3, axis=2)
    else:
        pixels = pixels + rng.normal(0, noise, pixels.shape[:2] + (1,))
    return Image.fromarray(numpy.clip(pixels, 0, 255).astype("uint8"))


def flank_mean(top, middle):
    """Mean over both flanks of the least-squares slope between 20 and 80 % of the height, degrees."""
    angles = []
    for side in (-1, 1):
        xs = middle + side * numpy.linspace(0, 0.8, 4001)
        ys = numpy.array([top(x) for x in xs])
        part = (ys - 0.25) / (ys[0] - 0.25)
        within = (part > 0.2) & (part < 0.8)
        angles.append(math.degrees(math.atan(abs(numpy.polyfit(xs[within], ys[within], 1)[0]))))
    return sum(angles) / 2


def heap(rng, grain=0.006, table=(90, 80, 70), wall=(225, 225, 220), bed=((150, 50), (120, 50), (60, 50)), round_top=0.02,
         base=0.0, shadow=False, blur=0.8, noise=5.0):
    """A heap from the side: picture, nothing, mean slope of its flanks in degrees."""
    big = 2
    left, right = math.radians(rng.uniform(20, 42)), math.radians(rng.uniform(20, 42))
    apex = (0.5 + rng.uniform(-0.05, 0.05), 0.75)
    high = rng.uniform(0.2, 0.3)
    ground = lambda x: 0.25 + base * (x - 0.5)

    def top(x):
        run = x - apex[0]
        t = math.tan(left) * -run if run < 0 else math.tan(right) * run
        t = math.sqrt(t * t + round_top**2) - round_top * 0.5
        return 0.25 + high - t

    image = Image.new("RGB", (big * 900, big * 600), wall)
    pen = ImageDraw.Draw(image)
    place = lambda x, y: (big * 900 * x, big * (600 - 900 * y + 60))
    pen.polygon([place(-0.1, ground(-0.1)), place(1.1, ground(1.1)), place(1.1, -0.5), place(-0.1, -0.5)], fill=table)
    if shadow:
        pen.ellipse([*place(0.05, 0.262), *place(0.95, 0.238)], fill=tuple(t // 2 for t in table))
    for y in numpy.arange(0.2, 0.7, 1.5 * grain):
        for x in numpy.arange(0, 1, 1.7 * grain):
            px, py = x + rng.normal(0, 0.3 * grain), y + rng.normal(0, 0.3 * grain)
            if py + grain > top(px) or py < ground(px):
                continue
            shade = rng.normal(0, 1)
            tone = tuple(int(numpy.clip(t + 0.3 * s * shade, 0, 255)) for t, s in bed)
            (u, v), w = place(px, py), big * 900 * grain
            pen.ellipse([u - w, v - w, u + w, v + w], fill=tone)
    return finish(image, rng, blur, noise), None, flank_mean(top, apex[0])


def shape(draw_it):
    """A picture of something that is no heap and no drum."""
    def make(rng):
        image = Image.new("RGB", (2 * 900, 2 * 600), (225, 225, 220))
        draw_it(ImageDraw.Draw(image), rng)
        return finish(image, rng, 0.8, 5.0), None, None
    return make


def cube(pen, rng):
    """A cube on a table, two of its faces seen."""
    edge = 2 * rng.uniform(180, 260)
    x, y, d = 600, 900 - edge, 0.3 * edge
    pen.rectangle([0, 900, 1800, 1200], fill=(90, 80, 70))
    pen.rectangle([x, y, x + edge, 900], fill=(150, 110, 60))
    pen.polygon([(x, y), (x + d, y - d), (x + edge + d, y - d), (x + edge, y)], fill=(190, 150, 90))


def ball(pen, rng):
    """A ball on a table."""
    r = 2 * rng.uniform(100, 160)
    pen.rectangle([0, 900, 1800, 1200], fill=(90, 80, 70))
    pen.ellipse([900 - r, 900 - 2 * r, 900 + r, 900], fill=(150, 110, 60))


def from_above(pen, rng):
    """A heap from above: a disc of grains in the middle of the table."""
    r = 2 * rng.uniform(150, 220)
    pen.rectangle([0, 0, 1800, 1200], fill=(90, 80, 70))
    for _ in range(9000):
        a, s = rng.uniform(0, 2 * math.pi), r * math.sqrt(rng.uniform())
        u, v, t = 900 + s * math.cos(a), 600 + s * math.sin(a), int(rng.uniform(130, 190))
        pen.ellipse([u - 8, v - 8, u + 8, v + 8], fill=(t, t - 30, t - 80))


def towers(pen, rng):
    """Three boxes side by side."""
    pen.rectangle([0, 900, 1800, 1200], fill=(90, 80, 70))
    for k in range(3):
        high = 2 * rng.uniform(80, 250)
        pen.rectangle([400 + 350 * k, 900 - high, 650 + 350 * k, 900], fill=(150, 110, 60))


def chart(pen, _rng):
    """Lines of a diagram."""
    pen.line([200, 100, 200, 1000, 1700, 1000], fill=(0, 0, 0), width=6)
    for k in range(8):
        pen.rectangle([260 + 170 * k, 1000 - 90 * (k % 5 + 1), 380 + 170 * k, 1000], fill=(60, 90, 180))


def two_drums(rng):
    """A figure of two drums side by side."""
    first, _, _ = drum(rng)
    second, _, _ = drum(rng)
    image = Image.new("RGB", (2 * SIZE, SIZE))
    image.paste(first, (0, 0))
    image.paste(second, (SIZE, 0))
    return image, None, None


def over(draw_it):
    """A drum with something before it or cut away."""
    def make(rng):
        image, circle, truth = drum(rng)
        return draw_it(image, circle, rng), circle, truth
    return make


def labelled(image, circle, _rng):
    """A scale bar and words in the air and beside the drum."""
    pen = ImageDraw.Draw(image)
    cx, cy, r = circle
    pen.rectangle([cx - 0.55 * r, cy - 0.62 * r, cx - 0.15 * r, cy - 0.59 * r], fill=(0, 0, 0))
    pen.text((cx - 0.5 * r, cy - 0.58 * r), "20 mm", fill=(0, 0, 0))
    pen.text((10, 10), "run 7, 30 rpm", fill=(255, 255, 255))
    return image


def glare(image, circle, rng):
    """The lamp shines in the cover, over the surface."""
    cx, cy, r = circle
    light = Image.new("L", image.size, 0)
    x, y = cx + r * rng.uniform(-0.4, 0.4), cy + r * rng.uniform(-0.2, 0.3)
    ImageDraw.Draw(light).ellipse([x - 0.12 * r, y - 0.12 * r, x + 0.12 * r, y + 0.12 * r], fill=190)
    light = light.filter(ImageFilter.GaussianBlur(0.05 * r))
    return Image.composite(Image.new("RGB", image.size, (255, 255, 255)), image, light)


def cut_off(image, circle, _rng):
    """The lowest tenth of the drum lies beyond the edge of the picture."""
    return image.crop((0, 0, image.width, int(circle[1] + 0.8 * circle[2])))


def no_bed(fill):
    """An empty or a full drum."""
    def make(rng):
        image, _, _ = drum(rng, fill=fill)
        return image, None, None
    return make


BLUE = ((20, 15), (30, 20), (110, 50))
# Name, mode, picture, whether it has an angle.
KINDS = [
    ("grains of 1/50 of the radius", "drum", lambda r: drum(r), True),
    ("fine grains, S-shaped", "drum", lambda r: drum(r, grain=0.012, bend=0.35), True),
    ("grains of 1/20", "drum", lambda r: drum(r, grain=0.05), True),
    ("grains of 1/12", "drum", lambda r: drum(r, grain=0.083), True),
    ("a toe that turns up", "drum", lambda r: drum(r, toe=1.2, slope=math.radians(r.uniform(40, 48))), True),
    ("dark grains before light air", "drum", lambda r: drum(r, bed=((60, 40),) * 3, air=(235,) * 3), True),
    ("light grains before dark air", "drum", lambda r: drum(r, bed=((205, 50),) * 3, air=(30,) * 3, rim=(90,) * 3), True),
    ("dark blue grains before black", "drum", lambda r: drum(r, bed=BLUE, air=(8, 8, 8), rim=(70, 70, 70)), True),
    ("red grains before green of one grey", "drum", lambda r: drum(r, bed=((170, 40), (60, 30), (60, 30)), air=(60, 117, 60)), True),
    ("grains of two tones", "drum", lambda r: drum(r, bed=((120, 230),) * 3, air=(245,) * 3), True),
    ("two tones, rim invisible", "drum", lambda r: drum(r, bed=((60, 20),) * 3, rim=None, air=(235,) * 3, outside=(235,) * 3, binary=True), True),
    ("no rim, outside like the air", "drum", lambda r: drum(r, rim=None, air=(225,) * 3, outside=(225,) * 3), True),
    ("noise of 25 levels", "drum", lambda r: drum(r, noise=25.0), True),
    ("blur of 4 pixels", "drum", lambda r: drum(r, blur=4.0), True),
    ("a drum of 90 pixels", "drum", lambda r: drum(r, radius=90.0, grain=0.04), True),
    ("words and a scale bar", "drum", over(labelled), True),
    ("glare over the surface", "drum", over(glare), True),
    ("a tenth below the edge of the picture", "drum", over(cut_off), True),
    ("empty drum", "drum", no_bed(-1.6), False),
    ("full drum", "drum", no_bed(2.2), False),
    ("two drums", "drum", two_drums, False),
    ("a diagram", "drum", shape(chart), False),
    ("heap", "heap", lambda r: heap(r), True),
    ("heap of coarse grains", "heap", lambda r: heap(r, grain=0.014), True),
    ("heap in noise and blur", "heap", lambda r: heap(r, blur=2.5, noise=20.0), True),
    ("heap, its shadow on the table", "heap", lambda r: heap(r, shadow=True), True),
    ("heap, table of its tone", "heap", lambda r: heap(r, table=(150, 120, 60)), True),
    ("heap, table leaning by 3 degrees", "heap", lambda r: heap(r, base=0.052), True),
    ("heap, round top", "heap", lambda r: heap(r, round_top=0.07), True),
    ("cube", "heap", shape(cube), False),
    ("ball", "heap", shape(ball), False),
    ("heap from above", "heap", shape(from_above), False),
    ("three boxes", "heap", shape(towers), False),
    ("a diagram as a heap", "heap", shape(chart), False),
]


def measured(program, file, flags):
    """Angle and interval in degrees, or none."""
    words = [program, file, "--json", "--quiet", *flags]
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=120)
    if not done.stdout:
        return None, done.stderr
    found = json.loads(done.stdout)
    picture = found.get("photos", found.get("images", [found]))[0] if isinstance(found, dict) else found[0]
    if done.returncode != 0:
        return None, str(picture.get("reason"))
    return (picture["angle_deg"], picture["angle_interval_deg"]), ""


def trial(program, mode, made, has_angle, name, folder):
    """One row of numbers."""
    at_once = pointed = never = held = 0
    errors = []
    for number, (image, circle, truth) in enumerate(made):
        file = folder / f"{number}.png"
        image.save(file)
        flags = ["--mode", mode]
        found, said = measured(program, file, flags)
        again = False
        if found is None and circle is not None and has_angle:
            again = True
            found, said = measured(program, file, [*flags, "--drum", ",".join(f"{v:.1f}" for v in circle)])
        if found is None:
            never += 1
            print(f"{name} {number}: {' '.join(said.split())}", file=sys.stderr)
            continue
        at_once += not again
        pointed += again
        if has_angle and truth is not None:
            error = found[0] - truth
            errors.append(error)
            held += found[1] is not None and found[1][0] <= truth <= found[1][1]
            print(f"{name} {number}: {found[0]:.2f} for {truth:.2f}", file=sys.stderr)
        else:
            print(f"{name} {number}: {found[0]:.2f} read", file=sys.stderr)
    if not errors:
        return f"{at_once} | {pointed} | {never} | | | "
    rms = math.sqrt(sum(e * e for e in errors) / len(errors))
    return f"{at_once} | {pointed} | {never} | {rms:.2f} | {max(errors, key=abs):+.2f} | {held} of {len(errors)}"


def main():
    """Prints the table."""
    count = int(sys.argv[1])
    programs = [runs.program("angle-from-image"), *(pathlib.Path(word).resolve() for word in sys.argv[2:])]
    print("| picture | read | with --drum | refused | rms, deg | worst, deg | interval holds |\n|---|--:|--:|--:|--:|--:|--:|")
    with tempfile.TemporaryDirectory() as folder:
        for kind, (name, mode, make, has_angle) in enumerate(KINDS):
            if os.environ.get("KIND", "") not in name:
                continue
            made = [make(numpy.random.default_rng([kind, number])) for number in range(count)]
            for program in programs:
                print(f"| {name} | {trial(program, mode, made, has_angle, name, pathlib.Path(folder))} |", flush=True)


main()
