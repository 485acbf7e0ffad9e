"""Loads libraries: the engine's, checked, and those of FMUs."""

from __future__ import annotations

from ctypes import CDLL, POINTER, c_double, c_int32, c_int64, c_uint64, c_void_p
from functools import cache
from pathlib import Path

from navfmu.engine import structures
from navfmu.engine.library import binary
from navfmu.engine.structures import Callbacks, Log, Master
from navfmu.errors import NavfmuError


@cache
def engine_library() -> CDLL:
    """The engine's C library, checked to mean the same structures as ``structures``."""
    path = binary()
    library = load(path, "the engine's binary")
    structures.check(library, f"the engine's binary {path}")
    library.initialise.argtypes = [POINTER(Master)]
    library.advance.argtypes = [POINTER(Master), c_int64]
    library.prepare_callbacks.argtypes = [POINTER(Callbacks), POINTER(Log)]
    library.prepare_callbacks.restype = None
    library.watch.argtypes = [c_void_p, c_void_p, c_void_p, c_double]
    library.watch.restype = None
    library.make_ordinary.argtypes, library.make_ordinary.restype = [], c_int32
    library.floating_now.argtypes, library.floating_now.restype = [], c_uint64
    library.put_back.argtypes, library.put_back.restype = [c_uint64], None
    return library


def load(path: Path, what: str) -> CDLL:
    """A library; ``what`` it is begins the sentence when it cannot be loaded."""
    try:
        return CDLL(str(path))
    except OSError as error:
        raise NavfmuError(f"{what} {path} cannot be loaded: {str(error).removeprefix(f'{path}: ')}") from None
