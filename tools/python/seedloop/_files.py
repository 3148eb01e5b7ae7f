"""Arrays, tables and dicts as the files that the programs read."""

from __future__ import annotations

import csv
import json
import os
import re
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from hashlib import sha256
from pathlib import Path
from typing import Any, Optional

import numpy as np

from ._programs import Folder

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

#: Triangles of a binary STL file, little endian.
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def path_of_picture(picture: Any, folder: Folder) -> str:
    """A file as it is; an array as a portable bitmap of 24 bits (BMP)."""
    if not isinstance(picture, np.ndarray):
        return os.fspath(picture)
    if picture.dtype != np.uint8 or picture.ndim not in (2, 3) or picture.shape[2:] not in ((), (3,)):
        raise ValueError(
            "a picture is an array of uint8, shape (height, width) or (height, width, 3), not "
            f"{picture.dtype} {picture.shape}"
        )
    if picture.ndim == 2:
        picture = np.repeat(picture[:, :, None], 3, axis=2)
    height, width = picture.shape[:2]
    # Rows from the bottom up, blue first, each padded to a multiple of four bytes.
    rows = np.zeros((height, (3 * width + 3) // 4 * 4), np.uint8)
    rows[:, : 3 * width] = picture[::-1, :, ::-1].reshape(height, 3 * width)
    size = 54 + rows.size
    header = b"BM" + np.array([size, 0, 54, 40], "<u4").tobytes()
    header += np.array([width, height], "<i4").tobytes() + np.array([1, 24], "<u2").tobytes()
    header += np.zeros(6, "<u4").tobytes()
    path = folder.path("picture.bmp")
    Path(path).write_bytes(header + rows.tobytes())
    return path


def path_of_mesh(mesh: Any, folder: Folder) -> str:
    """A file as it is; vertices and triangles as STL."""
    if isinstance(mesh, (str, os.PathLike)):
        return os.fspath(mesh)
    vertices, triangles = (np.asarray(part) for part in mesh)
    if vertices.ndim != 2 or vertices.shape[1] != 3 or triangles.ndim != 2 or triangles.shape[1] != 3:
        raise ValueError(
            "a mesh is vertices, shape (n, 3), and triangles, shape (m, 3), not "
            f"{vertices.shape} and {triangles.shape}"
        )
    if triangles.size and not (0 <= triangles.min() and triangles.max() < len(vertices)):
        raise ValueError(f"a triangle names a vertex outside 0 to {len(vertices) - 1}")
    content = np.zeros(len(triangles), TRIANGLE)
    content["corners"] = vertices[triangles]
    path = folder.path("mesh.stl")
    head = b"binary".ljust(80) + np.array([len(triangles)], "<u4").tobytes()
    Path(path).write_bytes(head + content.tobytes())
    return path


def path_of_json(content: Any, folder: Folder, name: str) -> str:
    """A file as it is; a dict as JSON."""
    if not isinstance(content, Mapping):
        return os.fspath(content)
    path = folder.path(name)
    Path(path).write_text(json.dumps(content), encoding="utf-8")
    return path


def path_of_table(table: Any, folder: Folder, name: str) -> str:
    """A file as it is; a dict of columns, a list of dicts or a data frame as CSV."""
    if isinstance(table, (str, os.PathLike)):
        return os.fspath(table)
    path = folder.path(name)
    if hasattr(table, "to_csv"):
        table.to_csv(path, index=False)
        return path
    if isinstance(table, Mapping):
        lengths = {len(column) for column in table.values()}
        if len(lengths) > 1:
            raise ValueError(f"the columns of a table have different lengths: {sorted(lengths)}")
        names = list(table)
        rows = [list(row) for row in zip(*table.values())]
    else:
        records = list(table)
        names = list(records[0]) if records else []
        rows = [[record[key] for key in names] for record in records]
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(names)
        writer.writerows(rows)
    return path


def table_of(path: str) -> dict[str, list[Any]]:
    """The columns of a CSV file, numbers as numbers."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    if not rows:
        return {}
    return {name: [_number(row[i]) for row in rows[1:]] for i, name in enumerate(rows[0])}


def _number(text: str) -> Any:
    """A cell as a whole number, a number or a text."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text


def read_toml(path: Any) -> dict[str, Any]:
    """The content of a TOML file."""
    with open(path, "rb") as file:
        return tomllib.load(file)


@contextmanager
def path_of_toml(content: Any, beside: Optional[Path] = None) -> Iterator[str]:
    """A file as it is; a dict as TOML beside the files it names, for as long as it is used."""
    if not isinstance(content, Mapping):
        yield os.fspath(content)
        return
    text = toml_text(content).encode()
    folder = beside or Path.cwd()
    # The same name for the same content: results tell their inputs by name.
    path = str(folder / f"seedloop-{sha256(text).hexdigest()[:12]}.toml")
    try:
        handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    except FileExistsError:  # Another process reads the same content.
        handle, path = tempfile.mkstemp(".toml", "seedloop-", str(folder))
    try:
        with open(handle, "wb") as file:
            file.write(text)
        yield path
    finally:
        os.unlink(path)


@contextmanager
def with_scene_files(study: Mapping[str, Any], beside: Optional[Path] = None) -> Iterator[dict[str, Any]]:
    """A study whose scenes are all files: a scene that is a dict is written as one, for as long as it is used."""
    with ExitStack() as stack:
        scenes = [
            {**scene, "file": Path(stack.enter_context(path_of_toml(scene["file"], beside))).name}
            if isinstance(scene.get("file"), Mapping)
            else scene
            for scene in study.get("scene", [])
        ]
        yield {**study, "scene": scenes} if scenes else dict(study)


def toml_text(content: Mapping[str, Any]) -> str:
    """A dict as TOML: one line a key, tables in one line."""
    return "".join(f"{_key(key)} = {_value(value)}\n" for key, value in content.items())


def _key(key: str) -> str:
    """A key, in quotes where it needs them."""
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else json.dumps(key)


def _value(value: Any) -> str:
    """A value as TOML writes it."""
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, (str, os.PathLike)):
        return json.dumps(os.fspath(value), ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Mapping):
        pairs = (f"{_key(key)} = {_value(one)}" for key, one in value.items())
        return "{ " + ", ".join(pairs) + " }"
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(map(_value, value)) + "]"
    raise TypeError(f"TOML has no form for {type(value).__name__}: {value!r}")
