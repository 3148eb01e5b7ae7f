"""A Python function as the simulator of a study.

The study's program is `_shim`: started once a run, it hands the request to the process that called `calibrate` or
`diagnose`, waits for the function there, and writes what it gave.
"""

from __future__ import annotations

import json
import sys
import threading
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection, Listener
from pathlib import Path
from secrets import token_hex
from typing import Any, Callable

from ._shim import ADDRESS, KEY

Simulator = Callable[[Mapping[str, Any]], Mapping[str, Any]]


@contextmanager
def serving(simulator: Simulator, version: str) -> Iterator[tuple[dict[str, Any], dict[str, str]]]:
    """Answer requests by a function; gives the study's entry and the environment of its program."""
    key = token_hex(16)
    with Listener(authkey=key.encode()) as listener:
        threading.Thread(target=_listen, args=(listener, simulator), daemon=True).start()
        entry = {
            "kind": "command",
            "command": [sys.executable, str(Path(__file__).with_name("_shim.py"))],
            "version": version,
            "results": {"observables": "results.json"},
        }
        yield entry, {ADDRESS: str(listener.address), KEY: key}


def _listen(listener: Listener, simulator: Simulator) -> None:
    """Answer each request on a thread of its own until the listener is closed."""
    while True:
        try:
            connection = listener.accept()
        except OSError:
            return
        except Exception:  # A stranger without the word: the others go on.
            continue
        threading.Thread(target=_answer, args=(connection, simulator), daemon=True).start()


def _answer(connection: Connection, simulator: Simulator) -> None:
    """Answer one request: observables, or why there are none."""
    with connection, suppress(EOFError, OSError):
        request = json.loads(connection.recv_bytes())
        request["condition"] = {name: _level(text) for name, text in request["condition"].items()}
        try:
            text = json.dumps({"observables": dict(simulator(request))}, default=float)
        except Exception:
            text = json.dumps({"error": traceback.format_exc()})
        connection.send_bytes(text.encode())


def _level(text: Any) -> Any:
    """The level of a condition: a number, or the word that it is."""
    try:
        return float(text)
    except ValueError:
        return text
