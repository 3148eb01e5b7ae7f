"""The wheel as it is installed: each function against a known answer."""

import json
import math
import random
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import numpy as np

import seedloop
from seedloop._files import path_of_picture, read_toml, toml_text
from seedloop._files import tomllib as _toml
from seedloop._programs import Folder
from seedloop._version import version_of

FIXTURES = Path(__file__).resolve().parents[3] / "fixtures"


def drum(angle_deg, size=400):
    """A dark half-full bed in a lighter drum on white, its surface inclined; (height, width, 3)."""
    down, right = np.mgrid[:size, :size] - size / 2.0
    radius = 0.45 * size
    inside = np.hypot(right, down) < radius
    slope = math.tan(math.radians(angle_deg))
    picture = np.full((size, size), 255, np.uint8)
    picture[inside] = 200
    picture[inside & (down > -slope * right)] = 40
    return np.repeat(picture[:, :, None], 3, axis=2)


def mill(run):
    """The closed form of fixtures/command-example: two frictions, a drum and a heap."""
    mu_s, mu_r = run["parameters"]["mu_s"], run["parameters"].get("mu_r", 0)
    cohesion = run["effects"].get("cohesion", 0)
    noise = random.Random(f"{run['scene']} {run['seed']} {mu_s} {mu_r}")
    if run["scene"] == "drum":
        rpm = run["condition"]["rpm"]
        slope = 0.20 + 0.75 * mu_s + 0.80 * mu_r + 0.004 * rpm + cohesion / rpm
        angle = math.degrees(math.atan(slope)) + noise.gauss(0, 0.2)
        return {"angle_deg": {"mean": angle, "sd": 0.5, "n": 9}}
    slope = 0.25 + 0.30 * mu_s + 1.60 * mu_r + 0.05 * cohesion
    return {"heap_deg": math.degrees(math.atan(slope)) + noise.gauss(0, 0.3)}


class Pictures(unittest.TestCase):
    def test_a_drawn_bed_has_its_angle(self):
        """A straight edge over 360 px is known to a few hundredths of a degree."""
        for picture in drum(33.0), drum(33.0)[:, :, 0]:
            answer = seedloop.read_angle(picture)
            self.assertTrue(answer.met)
            self.assertAlmostEqual(answer["angle_deg"], 33.0, delta=0.1)

    def test_a_blank_picture_is_refused_with_a_reason(self):
        answer = seedloop.read_angle(np.zeros((60, 80), np.uint8))
        self.assertFalse(answer.met)
        self.assertTrue(answer["reason"])

    def test_an_array_that_is_no_picture_is_told(self):
        with self.assertRaisesRegex(ValueError, "uint8.*float64"):
            seedloop.read_angle(np.zeros((60, 80)))

    def test_pixels_arrive_where_they_were(self):
        """Header by the format's definition; rows from the bottom up, blue first, padded to four bytes."""
        picture = np.arange(2 * 3 * 3, dtype=np.uint8).reshape(2, 3, 3)
        with Folder() as folder:
            content = Path(path_of_picture(picture, folder)).read_bytes()
        self.assertEqual(len(content), 54 + 2 * 12)
        self.assertEqual(content[54:63], bytes(picture[1, :, ::-1].reshape(-1)))

    def test_a_missing_file_is_named(self):
        with self.assertRaisesRegex(seedloop.Error, "nowhere.png") as caught:
            seedloop.read_angle("nowhere.png")
        self.assertEqual(caught.exception.exit_code, 2)


class Bodies(unittest.TestCase):
    corners = np.array([[x, y, z] for x in (0, 8) for y in (0, 6) for z in (0, 4)], float)
    triangles = np.array(
        [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]]
        + [[2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
    )

    def test_a_box_is_filled_inside_its_walls(self):
        """Spheres of radius 1 neither overlap nor leave the box, by 1e-4 of a radius; the volume is that of the box."""
        answer = seedloop.fill((self.corners, self.triangles), 1)
        spheres = np.array(answer["sphere_list"])
        centres, radius = spheres[:, :3], spheres[:, 3:]
        self.assertTrue((centres - radius >= -1e-4).all())
        self.assertTrue((centres + radius <= self.corners[-1] + 1e-4).all())
        pairs = np.triu_indices(len(centres), 1)
        apart = np.linalg.norm(centres[:, None] - centres[None], axis=2)[pairs]
        self.assertGreater(apart.min(), 2 - 1e-4)
        self.assertGreaterEqual(len(spheres), 4 * 3 * 2)
        self.assertAlmostEqual(answer["mesh"]["volume_mm3"], 192, places=3)

    def test_a_sphere_that_does_not_fit_is_an_answer(self):
        answer = seedloop.fill((self.corners, self.triangles), 3)
        self.assertFalse(answer.met)
        self.assertEqual(answer["verdict"], "refused")

    def test_a_triangle_without_its_vertex_is_told(self):
        with self.assertRaisesRegex(ValueError, "outside 0 to 7"):
            seedloop.fill((self.corners, self.triangles + 1), 1)


class Experiments(unittest.TestCase):
    factors = [{"symbol": s, "name": f"factor {s}", "unit": "1", "low": 0, "high": 10} for s in "AB"]

    def test_a_surface_comes_back_and_is_solved(self):
        """y = 3 + 2 A - B + 0.5 A B with noise of 1e-6: coefficients to 1e-4; it reaches -7 to 63, and so 10."""
        runs = seedloop.design("ccd", self.factors, seed=2)
        self.assertEqual(len(runs["run"]), 13)
        a, b = np.array(runs["A_natural"]), np.array(runs["B_natural"])
        noise = 1e-6 * np.random.default_rng(1).standard_normal(len(a))
        data = {"A": a, "B": b, "y": 3 + 2 * a - b + 0.5 * a * b + noise}
        analysis = seedloop.analyse(data, "A=0:10,B=0:10", "y", model="1 + A + B + A:B", natural=True)
        for term, value in {"1": 3, "A": 2, "B": -1, "AB": 0.5}.items():
            self.assertAlmostEqual(analysis["terms_natural"][term]["coef"], value, places=4)
        best = seedloop.optimise(analysis, target=10)
        self.assertTrue(best["exists"])
        self.assertAlmostEqual(best["reachable"]["min"]["value"], -7, places=3)
        self.assertAlmostEqual(best["reachable"]["max"]["value"], 63, places=3)

    def test_columns_of_different_length_are_told(self):
        with self.assertRaisesRegex(ValueError, "different lengths"):
            seedloop.analyse({"A": [1, 2], "y": [1]}, "A=0:1", "y")


class Runs(unittest.TestCase):
    scene = FIXTURES / "peers-study" / "spheres.toml"

    def test_a_scene_gives_the_same_as_a_file_and_as_a_dict(self):
        by_file = seedloop.simulate(self.scene, {"frames": 2})
        content = read_toml(self.scene)
        content["protocol"]["frames"] = 2
        by_dict = seedloop.simulate(content, frame=True)
        self.assertEqual(by_file["observables"], by_dict["observables"])
        self.assertTrue(by_dict["frame_png"].startswith(b"\x89PNG"))

    def test_frames_are_arrays_in_the_drum(self):
        """Every bead lies in the drum of 60 mm by 16 mm but for an overlap below 1 % of its radius, and the ruler reads the
        pictures as the run did."""
        answer = seedloop.simulate(self.scene, arrays=True)
        arrays = answer["arrays"]
        position, radius = arrays["position_m"], arrays["spheres_0_m"][0, 3]
        self.assertEqual(position.shape, (len(arrays["time_s"]), 260, 3))
        self.assertTrue((np.diff(arrays["time_s"]) > 0).all())
        self.assertTrue(np.allclose(np.linalg.norm(arrays["orientation"], axis=2), 1))
        self.assertLess(np.hypot(position[..., 0], position[..., 1]).max(), 30e-3 - 0.99 * radius)
        self.assertLess(np.abs(position[..., 2]).max(), 8e-3 - 0.99 * radius)
        # A fall through the whole drum ends at 1.1 m/s.
        self.assertLess(np.abs(arrays["velocity_m_s"]).max(), 1.1)
        read = [seedloop.read_angle(picture) for picture in arrays["picture"]]
        angles = [answer["angle_deg"] for answer in read if answer.met]
        self.assertEqual(len(angles), len(answer["frames"]["angles_deg"]))
        for angle, told in zip(angles, answer["frames"]["angles_deg"]):
            self.assertAlmostEqual(angle, told, places=9)

    def test_a_setting_that_is_none_is_named(self):
        with self.assertRaisesRegex(seedloop.Error, "no_such_setting"):
            seedloop.simulate(self.scene, {"no_such_setting": 1})

    def test_a_dict_is_the_toml_that_it_says(self):
        content = {
            "name": 'a "b" \\ \n é',
            "numbers": [1, 2.5, -1e-300, True],
            "table": {"dotted.key": {"deep": [{"a": 1}, {"a": 2}]}},
        }
        self.assertEqual(_toml.loads(toml_text(content)), content)


class Files(unittest.TestCase):
    def test_a_study_is_begun_exported_and_run(self):
        """The example study of `init`, its drum as a deck, and two speeds of it by a table."""
        with tempfile.TemporaryDirectory() as folder:
            files = [Path(file) for file in seedloop.init("drum", folder)["files"]]
            self.assertTrue(all(file.exists() for file in files))
            scene = FIXTURES / "peers-study" / "spheres.toml"
            settings = {"frames": 2, "time_s": 0.2}
            deck = seedloop.export("lammps", scene, folder + "/deck", settings)
            self.assertTrue(all((Path(folder) / "deck" / name).exists() for name in deck["files"]))
            done = seedloop.run({"rpm": [20, 30]}, scene, folder + "/runs", settings, progress=False)
            self.assertTrue(done.met)
            self.assertEqual([run["problem"] for run in done["runs"]], [None, None])
            self.assertEqual(done["table"]["rpm"], [20, 30])
            with self.assertRaisesRegex(seedloop.Error, "exists"):
                seedloop.init("drum", folder)


class Versions(unittest.TestCase):
    """What the version of a function counts."""

    def differ(self, one, other):
        self.assertNotEqual(version_of(one), seedloop._version.version_of(other))

    def same(self, one, other):
        self.assertEqual(version_of(one), seedloop._version.version_of(other))

    def test_code_defaults_and_variables_count(self):
        def scaled(k, data=()):
            return lambda run, offset=0.0: k * run["x"] + offset + len(data)

        self.same(scaled(1.0), scaled(1.0))
        self.differ(scaled(1.0), scaled(1.0 + 1e-15))
        self.differ(scaled(1.0), scaled(1.0, np.arange(3)))
        self.same(scaled(1.0, {"a", "b", "c"}), scaled(1.0, {"c", "b", "a"}))
        self.differ(lambda run, offset=0.0: offset, lambda run, offset=1.0: offset)
        self.differ(lambda run: run["a"], lambda run: run["b"])
        self.differ(lambda run: run.a, lambda run: run.b)

    def test_what_a_function_calls_counts(self):
        """A function of the module, by its global name, and a class with its methods; not where they are written."""
        space = {"math": math}
        text = "def inner(x):\n    return {} * x\nclass Model:\n    k = {}\n    def angle(self, x):\n        return inner(x) + self.k\n"
        text += "def outer(run):\n    return Model().angle(math.sin(run['x']))\n"
        versions = []
        for a, b, before in (2, 1, ""), (2, 1, "\n\n# moved\n"), (3, 1, ""), (2, 5, ""):
            exec(before + text.format(a, b), space)
            versions.append(version_of(space["outer"]))
        self.assertEqual(versions[0], versions[1])
        self.assertEqual(len(set(versions)), 3)

    def test_what_has_no_digest_asks_for_a_version(self):
        source = (number for number in range(3))
        with self.assertRaisesRegex(seedloop.Error, "source.*generator.*version="):
            seedloop.calibrate(FIXTURES / "command-example" / "study.toml", lambda run: {"angle_deg": next(source)})


class Studies(unittest.TestCase):
    study = FIXTURES / "command-example" / "study.toml"

    def test_a_function_is_calibrated(self):
        """The frictions of the example, 0.45 and 0.12, lie within three standard errors of what is found."""
        with tempfile.TemporaryDirectory() as folder:
            answer = seedloop.calibrate(self.study, mill, out=folder + "/out")
        found = {p["symbol"]: (p["value"], p["se"]) for p in answer["parameters"]}
        for name, truth in {"mu_s": 0.45, "mu_r": 0.12}.items():
            value, error = found[name]
            self.assertLess(abs(value - truth), 3 * error, name)

    def test_a_scene_of_a_study_may_be_a_dict(self):
        """The plan reads the scene as it reads its file, and nothing of it stays behind."""
        scene = read_toml(FIXTURES / "peers-study" / "spheres.toml")
        study = {
            "name": "dicts",
            "scene": [{"name": "drum", "file": scene}],
            "parameter": [{"symbol": "F", "sets": ["contact.bead-bead.static_friction"], "low": 0.2, "high": 0.5}],
            "measured": [{"scene": "drum", "role": "fit", "angle_deg": {"mean": 35, "sd": 1, "n": 9}}],
        }
        before = sorted(Path.cwd().iterdir())
        stages = seedloop.calibrate(study, plan=True)["stages"]
        self.assertGreater(sum(stage["runs"] for stage in stages), 0)
        self.assertEqual(sorted(Path.cwd().iterdir()), before)
        scene["contact"].pop("bead-wall")
        with self.assertRaisesRegex(seedloop.Error, "bead-wall"):
            seedloop.calibrate(study, plan=True)

    def calibrated(self, folder, function, **flags):
        """The study of one friction, angle = a + b mu + 0.13 rpm, by a function; the friction and the number of new runs."""
        measured = [
            {"scene": "drum", "condition": {"rpm": rpm}, "role": role, "angle_deg": {"mean": mean, "sd": 0.8, "n": 10}}
            for rpm, role, mean in ((15, "fit", 31.0), (30, "check", 33.0))
        ]
        study = {
            "name": "edited",
            "scene": [{"name": "drum", "observables": ["angle_deg"]}],
            "parameter": [{"symbol": "mu", "low": 0.1, "high": 0.6, "limits": [0, 2]}],
            "measured": measured,
            "design": {"before_runs": 0},
        }
        self.heard = []
        answer = seedloop.calibrate(study, function, out=folder, progress=self.heard.append, threads=2, **flags)
        return answer["parameters"][0]["value"], answer["cost"]["runs"]

    def test_an_edited_function_does_its_runs_anew(self):
        """31 = a + b mu + 1.95 by a = 20, b = 30 is mu = 0.302, by a = 10, b = 50 it is 0.381; noise of 0.1 makes 0.003."""

        def line(a, b):
            def drum(run):
                noise = 0.1 * ((run["seed"] * 7919) % 13 - 6) / 6
                return {"angle_deg": a + b * run["parameters"]["mu"] + 0.13 * run["condition"]["rpm"] + noise}

            return drum

        with tempfile.TemporaryDirectory() as folder:
            first, runs = self.calibrated(folder, line(20, 30))
            self.assertAlmostEqual(first, 0.302, delta=0.01)
            self.assertGreater(runs, 0)
            again, runs = self.calibrated(folder, line(20, 30), resume=True)
            self.assertEqual((again, runs), (first, 0))
            edited, runs = self.calibrated(folder, line(10, 50), force=True)
            self.assertAlmostEqual(edited, 0.381, delta=0.01)
            self.assertGreater(runs, 0)
            self.assertTrue(any("runs of this list" in text for text in self.heard), self.heard)

    def test_an_exception_fails_its_run_with_its_words(self):
        def broken(run):
            raise ValueError(f"no bed at seed {run['seed']}")

        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaisesRegex(seedloop.Error, "no bed at seed"):
                seedloop.calibrate(self.study, broken, out=folder + "/out")

    def test_a_linear_problem_is_diagnosed(self):
        """The stored problem of a drum has the answer that its fixture states."""
        folder = FIXTURES / "diagnosis" / "drum"
        problem = json.loads((folder / "problem.json").read_text(encoding="utf-8"))
        answer = seedloop.diagnose(problem)
        by_file = seedloop.diagnose(folder / "problem.json")
        self.assertEqual((answer["verdict"], answer["effects"]), (by_file["verdict"], by_file["effects"]))
        self.assertGreater(answer["structured_residual"]["t0"], 0)

    def test_an_interrupt_ends_the_program_too(self):
        """Within ten seconds and the time to say so, and with KeyboardInterrupt."""
        code = (
            "import seedloop, sys, time\n"
            "def slow(run):\n    time.sleep(60)\n"
            f"seedloop.calibrate({str(self.study)!r}, slow, out=sys.argv[1])\n"
        )
        with tempfile.TemporaryDirectory() as folder:
            line = [sys.executable, "-c", code, folder + "/out"]
            with subprocess.Popen(line, stderr=subprocess.PIPE, text=True) as python:
                time.sleep(3)
                begin = time.monotonic()
                python.send_signal(signal.SIGINT)
                _, error = python.communicate(timeout=30)
            self.assertIn("KeyboardInterrupt", error)
            self.assertLess(time.monotonic() - begin, 12)


if __name__ == "__main__":
    unittest.main()
