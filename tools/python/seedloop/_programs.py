"""Find the programs, run them, read what they write."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Optional, Union

#: Whether the messages of a program are shown while it runs, or what gets each line of them.
Progress = Union[bool, None, Callable[[str], Any]]

#: Seconds that an interrupted program has to keep its state.
LEAVE_S = 10.0


class Error(RuntimeError):
    """What a program refused, in its words; ``exit_code`` is 2 for bad input, 130 or 143 for a stop."""

    def __init__(self, message: str, exit_code: int) -> None:
        super().__init__(message)
        self.exit_code = exit_code


class Answer(dict[str, Any]):
    """The JSON of a program. ``met``: whether it ended with exit code 0. ``log``: what it said."""

    def __init__(self, content: Mapping[str, Any], met: bool, log: str) -> None:
        super().__init__(content)
        self.met = met
        self.log = log


class Folder:
    """A folder of its own for the files of one call."""

    def __enter__(self) -> Folder:
        self._folder = tempfile.TemporaryDirectory(prefix="seedloop-")
        return self

    def __exit__(self, *_: object) -> None:
        self._folder.cleanup()

    def path(self, name: str) -> str:
        """The path of a file in it."""
        return str(Path(self._folder.name) / name)


def program(name: str) -> str:
    """The path of a program: beside this Python, or on the search path."""
    beside = [Path(sys.executable).parent, Path(sysconfig.get_path("scripts"))]
    for folder in beside:
        found = shutil.which(name, path=str(folder))
        if found:
            return found
    found = shutil.which(name)
    if found is None:
        raise Error(f"the program {name} is not installed: pip install seedloop", 2)
    return found


def answer_of(
    name: str,
    arguments: Sequence[str],
    flags: Mapping[str, Any],
    folder: Folder,
    environment: Optional[Mapping[str, str]] = None,
) -> Answer:
    """Run a program with ``--json`` and give back what it wrote; the flag ``progress`` is for here."""
    flags = dict(flags)
    hear = _listener(flags.pop("progress", None))
    asked = flags.pop("json", None)
    out = str(asked) if asked else folder.path("answer.json")
    line = [program(name), *map(str, arguments), *_words(flags), "--json", out]
    code, log = _run(line, {**os.environ, **(environment or {})}, hear)
    if code not in (0, 1) or not Path(out).exists():
        raise Error(log.strip() or f"{name} ended with exit code {code}", code)
    return Answer(json.loads(Path(out).read_text(encoding="utf-8")), code == 0, log)


def _words(flags: Mapping[str, Any]) -> list[str]:
    """Keyword arguments as flags; what is False or None is left out."""
    words: list[str] = []
    for name, value in flags.items():
        flag = "--" + name.replace("_", "-")
        for one in value if isinstance(value, (list, tuple)) else [value]:
            if one is True:
                words.append(flag)
            elif one is not None and one is not False:
                # In one word: a value may begin with a minus sign.
                words.append(f"{flag}={one}")
    return words


def _listener(progress: Progress) -> Optional[Callable[[str], Any]]:
    """What gets each line of the messages."""
    if progress is True:
        # The stream of this moment: notebooks and tests put others in its place.
        return lambda text: print(text, file=sys.stderr, flush=True)
    return progress or None


def _run(
    line: Sequence[str], environment: Mapping[str, str], hear: Optional[Callable[[str], Any]]
) -> tuple[int, str]:
    """Exit code and log of a program, whose lines are heard as they come. Ctrl-C reaches it once, and it keeps its state."""
    log: list[str] = []
    with subprocess.Popen(
        line,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        encoding="utf-8",
        errors="replace",
        start_new_session=True,
    ) as running:
        try:
            for text in running.stderr:
                log.append(text)
                if hear is not None:
                    hear(text.rstrip("\r\n"))
            running.wait()
        except BaseException:
            running.send_signal(signal.SIGINT)
            try:
                running.communicate(timeout=LEAVE_S)
            except subprocess.TimeoutExpired:
                running.kill()
            raise
        return running.returncode, "".join(log)
