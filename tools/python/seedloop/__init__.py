"""Contact parameters of seeds and grains, from Python.

Each function starts one of the programs that come with this package and gives back what it writes as JSON. Keyword
arguments are the flags of the program under the same name: ``all_points=True`` is ``--all-points``, ``seed=3`` is
``--seed 3``, a list repeats the flag. ``seedloop COMMAND --help`` lists them. Units stand in the names of keys.

What a program refuses raises `Error` with its words. An answer that is not met, which ends the program with exit code
1, is an `Answer` with ``met == False``.

``progress=`` says where the messages of a program go while it runs: ``True`` writes them to ``sys.stderr``, a function gets each line,
``False`` keeps them for `Answer.log`, which has them in any case. `simulate`, `run`, `calibrate` and `diagnose` write them, the others
keep them, unless asked otherwise.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Callable, Optional, Union

import numpy as np

from ._callback import serving
from ._files import (
    path_of_json,
    path_of_mesh,
    path_of_picture,
    path_of_table,
    path_of_toml,
    read_toml,
    table_of,
    with_scene_files,
)
from ._programs import Answer, Error, Folder, answer_of
from ._version import Unknown, version_of

__all__ = [
    "Answer",
    "Error",
    "analyse",
    "calibrate",
    "design",
    "diagnose",
    "export",
    "fill",
    "init",
    "optimise",
    "read_angle",
    "run",
    "simulate",
]

PathLike = Union[str, "os.PathLike[str]"]
Table = Union[PathLike, Mapping[str, Sequence[Any]], Sequence[Mapping[str, Any]], Any]
Simulator = Callable[[Mapping[str, Any]], Mapping[str, Any]]


def read_angle(picture: Union[PathLike, np.ndarray], **flags: Any) -> Answer:
    """Read the angle of repose in a picture (`angle-from-image`).

    picture: a file, a folder of pictures, or an array of bytes, shape (height, width) grey or (height, width, 3) red,
    green, blue, row 0 at the top.

    Keys: ``angle_deg``, ``angle_se_deg``, ``verdict`` (``ok`` or ``refused``), ``reason``, ``drum`` (px), ``images`` (one
    entry a picture), ``summary``. `Answer.met` is false where a picture was refused.
    """
    with Folder() as folder:
        return answer_of("angle-from-image", [path_of_picture(picture, folder)], flags, folder)


def fill(
    mesh: Union[PathLike, tuple[np.ndarray, np.ndarray]],
    radius: Union[float, str],
    **flags: Any,
) -> Answer:
    """Fill a closed mesh with spheres (`seedfill`).

    mesh: an STL, OBJ or PLY file, or vertices, shape (n, 3), with triangles, shape (m, 3) of vertex numbers. Lengths are
    in mm; ``unit="m"`` and so on changes that.
    radius: of the spheres, or of the smallest one; a bare number is in the unit of the mesh.

    Keys: ``sphere_list`` (rows x, y, z, radius in the unit of the mesh), ``fit`` (errors of volume, inertia and surface),
    ``mesh``, ``mass_kg``. `Answer.met` is false where the filling was refused, with ``reason``.
    """
    with Folder() as folder:
        arguments = [path_of_mesh(mesh, folder)]
        return answer_of("seedfill", arguments, {"radius": radius, **flags}, folder)


def simulate(
    scene: Union[PathLike, Mapping[str, Any]],
    settings: Optional[Mapping[str, Any]] = None,
    frame: bool = False,
    arrays: bool = False,
    **flags: Any,
) -> Answer:
    """Run a scene (`seedloop simulate`).

    scene: a scene file, or its content as a dict; meshes are then looked for from the working directory.
    settings: changes by dotted path or short name, such as ``{"rpm": 20}``.
    frame: also give the last picture of the camera, under ``frame_png`` (bytes of a PNG).
    arrays: also give the frames as arrays, under ``arrays``, a dict: ``time_s``, shape (frames,); ``position_m`` of the
    centres of mass, (frames, seeds, 3); ``orientation``, quaternions w, x, y, z, (frames, seeds, 4); ``velocity_m_s`` and
    ``angular_velocity_rad_s``, (frames, seeds, 3); ``kind`` of each seed, (seeds,); ``spheres_0_m`` and so on, the spheres
    of each kind at the origin, rows x, y, z, radius; ``picture``, what the camera saw, (frames, height, width, 3), uint8.

    Keys: ``observables`` (by name: ``mean``, ``sd``, ``n``, ``unit``), ``regime``, and what the run rests on.
    """
    with Folder() as folder:
        flags = _with_progress(_with_settings(flags, settings))
        if frame:
            flags["frame"] = folder.path("frame.png")
        if arrays:
            flags["arrays"] = folder.path("arrays.npz")
        with path_of_toml(scene) as path:
            answer = answer_of("seedloop", ["simulate", path], flags, folder)
        if frame and answer.met:
            answer["frame_png"] = Path(flags["frame"]).read_bytes()
        if arrays and answer.met:
            with np.load(flags["arrays"]) as content:
                answer["arrays"] = dict(content)
        return answer


def init(kind: str, out: PathLike = ".", **flags: Any) -> Answer:
    """Write a commented study to start from, its scene, and the job script of a cluster (`seedloop init`).

    kind: ``drum``, ``heap`` or ``box``.
    out: the folder for the files.

    Keys: ``files``.
    """
    with Folder() as folder:
        return answer_of("seedloop", ["init", kind], {"out": out, **flags}, folder)


def export(
    format: str,
    scene: Union[PathLike, Mapping[str, Any]],
    out: PathLike,
    settings: Optional[Mapping[str, Any]] = None,
    **flags: Any,
) -> Answer:
    """Write a scene, or the frames of its run, for another tool (`seedloop export`).

    format: ``lammps``, ``liggghts``, ``edem``, ``vtk`` or ``csv``.
    scene, settings: as for `simulate`; ``set_file="parameters.toml"`` takes the values of a calibration.
    out: the folder for the files.

    Keys: ``files``, the names in the folder; ``warnings``, what whoever takes them over must know.
    """
    with Folder() as folder, path_of_toml(scene) as path:
        flags = {"out": out, **_with_settings(flags, settings)}
        return answer_of("seedloop", ["export", format, path], flags, folder)


def run(
    design: Table,
    scene: Union[PathLike, Mapping[str, Any]],
    out: PathLike,
    settings: Optional[Mapping[str, Any]] = None,
    **flags: Any,
) -> Answer:
    """Run every row of a design table (`seedloop run`).

    design: a table, as in `analyse`; a column that is named by a setting sets it.
    scene, settings: as for `simulate`; the same in all runs.
    out: the folder of the results; ``resume=True`` goes on in it.

    Keys: ``runs`` (one entry a run: ``observables``, ``parameters``, ``problem``), ``n_failed``; ``table``, the columns of the table of
    results, which `analyse` takes. `Answer.met` is false where a run gave no result.
    """
    with Folder() as folder, path_of_toml(scene) as path:
        table = path_of_table(design, folder, "design.csv")
        flags = {"scene": path, "out": out, **_with_progress(_with_settings(flags, settings))}
        answer = answer_of("seedloop", ["run", table], flags, folder)
        if "results" in answer:
            answer["table"] = table_of(answer["results"])
        return answer


def design(kind: str, factors: Table, **flags: Any) -> dict[str, list[Any]]:
    """Make a design of experiments (`seedloop design`).

    kind: ``pb``, ``bbd``, ``ccd``, ``full``, ``fraction``, ``dsd``, ``lhs``, ``d-optimal``, ``i-optimal``,
    ``steepest``.
    factors: a table with the columns symbol, name, unit, low, high: a CSV file, a dict of columns, a list of dicts, or a
    data frame.

    Gives a dict of columns, one entry a run, in the order in which to run them; ``pandas.DataFrame(...)`` takes it.
    """
    with Folder() as folder:
        table = path_of_table(factors, folder, "factors.csv")
        out = folder.path("design.csv")
        answer_of("seedloop", ["design", kind], {"factors": table, "out": out, **flags}, folder)
        return table_of(out)


def analyse(data: Table, factors: Union[str, Table], response: str, **flags: Any) -> Answer:
    """Fit a model to the table of an experiment (`seedloop analyse`).

    data: a table with one row a run: a CSV file, a dict of columns, a list of dicts, or a data frame.
    factors: ``"B=0.30:0.42,E=0.01:0.18"`` or a table as in `design`.
    response: the column to explain.
    """
    with Folder() as folder:
        table = path_of_table(data, folder, "data.csv")
        listed = factors if _is_list(factors) else path_of_table(factors, folder, "factors.csv")
        flags = {"factors": listed, "response": response, **flags}
        return answer_of("seedloop", ["analyse", table], flags, folder)


def optimise(analysis: Union[PathLike, Mapping[str, Any]], **flags: Any) -> Answer:
    """Find where a fitted surface meets a target (`seedloop optimise`).

    analysis: what `analyse` gave, or its file. ``target=38.2`` or ``goal="max"`` says what is wanted.
    """
    with Folder() as folder:
        path = path_of_json(analysis, folder, "analysis.json")
        return answer_of("seedloop", ["optimise", path], flags, folder)


def calibrate(
    study: Union[PathLike, Mapping[str, Any]],
    simulator: Optional[Simulator] = None,
    version: Optional[str] = None,
    **flags: Any,
) -> Answer:
    """Calibrate the parameters of a study on its measurements (`seedloop calibrate`).

    study: a study file, or its content as a dict; files in it are then looked for from the working directory, and the
    ``file`` of a scene may be the scene itself, a dict.
    simulator: does the runs in place of what the study says. It gets a dict (``scene``, ``condition``, ``parameters``,
    ``effects``, ``seed``) and gives a dict of observables, numbers or ``{"mean", "sd", "n"}``. It is called from
    several threads unless ``threads=1``, with the same seed for the same run; an exception fails that run.
    version: a word for the version of the simulator, under which its runs are kept: another word, other runs. Without it that is its code,
    with its defaults, the variables and functions that it uses and the versions of libraries: an edited function does its runs anew. What
    the function reads from files cannot be seen, so give a word that changes with them. `Error` where the code uses something whose
    content has no digest.

    `Answer.met` is false where a check or a target is missed.
    """
    return _study("calibrate", study, simulator, version, flags)


def diagnose(
    study: Union[PathLike, Mapping[str, Any]],
    simulator: Optional[Simulator] = None,
    version: Optional[str] = None,
    **flags: Any,
) -> Answer:
    """Tell what a model lacks (`seedloop diagnose`).

    study: as for `calibrate`; or a linear problem, the content of a ``problem.json``, with its file or as a dict.

    Keys: ``verdict``, ``effects``, ``summary``, ``candidates``, ``structured_residual``.
    """
    if isinstance(study, Mapping) and "residual_obs_minus_sim" in study:
        with Folder() as folder:
            path = path_of_json(study, folder, "problem.json")
            return answer_of("seedloop", ["diagnose", path], flags, folder)
    return _study("diagnose", study, simulator, version, flags)


def _study(
    command: str,
    study: Union[PathLike, Mapping[str, Any]],
    simulator: Optional[Simulator],
    version: Optional[str],
    flags: Mapping[str, Any],
) -> Answer:
    """Run a study, by its own simulator or by a function."""
    with Folder() as folder, ExitStack() as stack:
        environment = {}
        beside = None
        if simulator is not None:
            if not isinstance(study, Mapping):
                beside = Path(study).parent
                study = read_toml(study)
            version = _version_by_code(simulator) if version is None else version
            entry, environment = stack.enter_context(serving(simulator, version))
            study = {**study, "simulator": entry}
        if isinstance(study, Mapping):
            study = stack.enter_context(with_scene_files(study, beside))
        path = stack.enter_context(path_of_toml(study, beside))
        return answer_of("seedloop", [command, path], _with_progress(flags), folder, environment)


def _version_by_code(simulator: Simulator) -> str:
    """The version of a function by its code."""
    try:
        return f"python {version_of(simulator)}"
    except Unknown as why:
        raise Error(
            f"the version of the simulator cannot be derived from {why}; give version=\"...\", a word that you change with the function "
            "and with what it uses",
            2,
        ) from why


def _with_progress(flags: Mapping[str, Any]) -> dict[str, Any]:
    """Flags of a program that may take long: its messages are shown unless the caller says otherwise."""
    return {"progress": True, **flags}


def _with_settings(flags: Mapping[str, Any], settings: Optional[Mapping[str, Any]]) -> dict[str, Any]:
    """Flags with settings of a scene."""
    changes = [f"{name}={_word(value)}" for name, value in (settings or {}).items()]
    return {**flags, "set": [*_listed(flags.get("set")), *changes]}


def _is_list(factors: Any) -> bool:
    """Whether factors are given as ``B=0.30:0.42,...``."""
    return isinstance(factors, str) and "=" in factors


def _listed(value: Any) -> list[Any]:
    """A flag that may be given several times, as a list."""
    if value is None:
        return []
    return list(value) if isinstance(value, (list, tuple)) else [value]


def _word(value: Any) -> str:
    """A setting as the command line takes it."""
    return str(value).lower() if isinstance(value, bool) else str(value)
