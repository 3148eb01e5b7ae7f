"""The version of a Python function: a digest of its code and of all that the code refers to.

Runs are kept under it, so that an edited function never answers with the runs of the one before. Counted are the bytecode of the
function, its defaults, the variables that it closes over, the globals that it names, and the same of every function and class
among these. A library, which is what lies where Python installs packages, counts by its name and version. What a function reads
from files, from the environment or by names that it makes while it runs cannot be seen from its code.
"""

from __future__ import annotations

import builtins
import dis
import functools
import hashlib
import io
import pickle
import site
import sys
import sysconfig
import threading
import types
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, Optional

#: Attributes of a class that say where and how it was written, not what it does.
ASIDE = {
    "__abstractmethods__",
    "__annotate__",
    "__annotate_func__",
    "__annotations__",
    "__annotations_cache__",
    # Its defaults are those of the attributes and of the methods that were made of it.
    "__dataclass_fields__",
    "__dataclass_params__",
    "__dict__",
    "__doc__",
    "__firstlineno__",
    "__module__",
    "__qualname__",
    "__static_attributes__",
    "__weakref__",
    "_abc_impl",
}
#: The version of Python, that of all that comes with it.
PYTHON = sys.version.partition(" ")[0]
#: Kinds without a content of their own.
EMPTY = (type(threading.Lock()), type(threading.RLock()), types.MemberDescriptorType, types.GetSetDescriptorType)
#: Instructions that take a variable by its name, and those that take an attribute of what was taken before.
GLOBAL, CLOSED, ATTRIBUTE = {"LOAD_GLOBAL", "LOAD_NAME"}, {"LOAD_DEREF"}, {"LOAD_ATTR", "LOAD_METHOD"}


class Unknown(Exception):
    """Something whose content has no digest: the rest of a sentence that begins with it."""


def version_of(function: Callable[..., Any]) -> str:
    """The version of a function, 16 hexadecimal digits; `Unknown` if something that it uses has none."""
    return _Reader().digest(function, "the function")[:16]


class _Pickler(pickle.Pickler):
    """Pickles values, with code by its content where pickle has names. Equal bytes mean equal content."""

    def __init__(self, file: io.BytesIO, reader: _Reader) -> None:
        super().__init__(file, protocol=4)
        # Without a memo: what is there once and what is there twice in equal form give the same bytes.
        self.fast = True
        self._reader = reader

    def persistent_id(self, value: Any) -> Optional[str]:
        return self._reader.token(value)


class _Reader:
    """Reads what a function refers to."""

    def __init__(self) -> None:
        #: What was met so far, in the order in which it was; kept, so that no identity is given twice.
        self._met: dict[int, tuple[int, Any]] = {}

    def digest(self, value: Any, name: str) -> str:
        """The digest of a value; its name is for messages."""
        file = io.BytesIO()
        try:
            _Pickler(file, self).dump(value)
        except Unknown:
            raise
        except Exception as why:
            raise Unknown(f"{name} ({type(value).__name__}): {why}") from why
        return _hash(file.getvalue())

    def token(self, value: Any) -> Optional[str]:
        """What stands for a value; None where pickle has its content."""
        if isinstance(value, types.CodeType):
            return self._code(value)
        if isinstance(value, types.ModuleType):
            return self._module(value)
        if isinstance(value, (set, frozenset)):
            # Their order is another one in each process.
            return "set " + " ".join(sorted(self.digest(one, "an element of a set") for one in value))
        if isinstance(value, types.MappingProxyType):
            return "proxy" + self.digest(dict(value), "a mapping")
        if isinstance(value, EMPTY):
            return type(value).__name__
        if isinstance(value, functools._lru_cache_wrapper):
            return self.digest(value.__wrapped__, value.__qualname__)
        if isinstance(value, (staticmethod, classmethod)):
            return type(value).__name__ + self.digest(value.__func__, "a method")
        if isinstance(value, property):
            return "property" + self.digest((value.fget, value.fset, value.fdel), "a property")
        if not isinstance(value, (types.FunctionType, type)):
            return None
        library = _library_of(value)
        if library is not None:
            return f"{value.__module__} {value.__qualname__} {library}"
        number, _ = self._met.get(id(value), (None, None))
        if number is not None:
            return f"met {number}"
        self._met[id(value)] = (len(self._met), value)
        return self._function(value) if isinstance(value, types.FunctionType) else self._class(value)

    def _function(self, function: types.FunctionType) -> str:
        """A function with what it refers to."""
        name = function.__qualname__
        closed: dict[str, Any] = {}
        for variable, cell in zip(function.__code__.co_freevars, function.__closure__ or ()):
            try:
                closed[variable] = cell.cell_contents
            except ValueError:  # It gets its value later.
                pass
        used = dict(_named(function.__code__, function.__globals__, closed, name))
        named = {path: self.digest(used[path], f"{path}, which {name} uses") for path in sorted(used)}
        defaults = self.digest((function.__defaults__, function.__kwdefaults__), f"a default of {name}")
        own = {key: value for key, value in vars(function).items() if key != "__wrapped__"}
        attributes = self.digest(own, f"an attribute of {name}")
        return _hash(repr((self._code(function.__code__), defaults, attributes, named)).encode())

    def _code(self, code: types.CodeType) -> str:
        """What code does, without where it was written."""
        counts = code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, code.co_flags
        names = code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars
        table = getattr(code, "co_exceptiontable", b"")
        return _hash(repr((counts, names, code.co_code, table, self.digest(code.co_consts, "a constant"))).encode())

    def _class(self, kind: type) -> str:
        """A class with its methods, its attributes and those of its bases."""
        content = {key: value for key, value in vars(kind).items() if key not in ASIDE}
        each = {key: self.digest(value, f"{kind.__qualname__}.{key}") for key, value in sorted(content.items())}
        return _hash(repr(([self.digest(base, "a base") for base in kind.__bases__], each)).encode())

    def _module(self, module: types.ModuleType) -> str:
        """A library."""
        library = _version_of_library(module)
        if library is None:
            raise Unknown(f"the module {module.__name__}: it is handed on as a whole")
        return f"{module.__name__} {library}"


def _named(
    code: types.CodeType, variables: Mapping[str, Any], closed: Mapping[str, Any], function: str
) -> Iterator[tuple[str, Any]]:
    """Paths and values of all that code takes by name; of a module of the user, what it takes from there."""
    instructions = [one for one in dis.get_instructions(code) if one.opname != "EXTENDED_ARG"]
    found: dict[str, Any] = {}
    for i, one in enumerate(instructions):
        if one.opname == "IMPORT_NAME":
            module = sys.modules.get(one.argval)
            if module is None or _version_of_library(module) is None:
                raise Unknown(f"{one.argval}, which {function} imports while it runs: import it before")
        if one.opname in GLOBAL and one.argval in variables:
            value = variables[one.argval]
        elif one.opname in CLOSED and one.argval in closed:
            value = closed[one.argval]
        else:
            continue
        path = one.argval
        for more in instructions[i + 1 :]:
            is_module = isinstance(value, types.ModuleType) and _version_of_library(value) is None
            if not is_module or more.opname not in ATTRIBUTE or not hasattr(value, more.argval):
                break
            value, path = getattr(value, more.argval), f"{path}.{more.argval}"
        found[path] = value
    # A variable that is closed over is read by functions inside, too.
    for name, value in closed.items():
        if not isinstance(value, types.ModuleType):
            found[name] = value
    yield from found.items()
    for inner in code.co_consts:
        if isinstance(inner, types.CodeType):
            yield from _named(inner, variables, closed, function)


def _library_of(value: Any) -> Optional[str]:
    """The version of the library that has a function or class under its name; None of one that is the user's, or that was made
    while a program ran."""
    module = sys.modules.get(getattr(value, "__module__", None) or "")
    found: Any = module
    for name in value.__qualname__.split("."):
        found = getattr(found, name, None)
    return _version_of_library(module) if module is not None and found is value else None


@functools.lru_cache(maxsize=None)
def _version_of_library(module: types.ModuleType) -> Optional[str]:
    """The version of a library; None of a module of the user."""
    if module is builtins or module.__name__ in sys.builtin_module_names:
        return PYTHON
    file = getattr(module, "__file__", None)
    if module.__name__ == "__main__" or file is None:
        # Parts of Python without a file, and packages that are a folder alone.
        return PYTHON if getattr(getattr(module, "__spec__", None), "origin", None) == "frozen" else None
    place = Path(file).resolve()
    # Installed packages lie inside the folder of the standard library, or in one of their own.
    for is_python, folder in _folders():
        if folder in place.parents:
            if is_python:
                return PYTHON
            top = sys.modules.get(module.__name__.partition(".")[0])
            version = getattr(top, "__version__", None)
            return str(version) if version else _hash(place.read_bytes())
    return None


@functools.lru_cache(maxsize=None)
def _folders() -> tuple[tuple[bool, Path], ...]:
    """The folders of installed packages, then those of Python itself, and which they are."""
    paths = sysconfig.get_paths()
    packages = {paths["purelib"], paths["platlib"], *site.getsitepackages(), site.getusersitepackages()}
    own = {paths["stdlib"], paths["platstdlib"]}
    return tuple([(False, Path(p).resolve()) for p in sorted(packages)] + [(True, Path(p).resolve()) for p in sorted(own)])


def _hash(content: bytes) -> str:
    """A digest, hexadecimal."""
    return hashlib.sha256(content).hexdigest()
