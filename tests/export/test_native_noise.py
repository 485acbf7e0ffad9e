"""The C implementation of the noise against NumPy's Philox and the Python one."""

import ctypes
import math

import numpy as np
import pytest

from navfmu.export.build import RUNTIME
from navfmu.export.toolchain import compile_shared

WORDS = ctypes.c_uint64 * 4
KEY = ctypes.c_uint64 * 2


@pytest.fixture(scope="module", params=["128-bit", "portable"])
def library(request, tmp_path_factory):
    path = tmp_path_factory.mktemp("noise") / "noise.so"
    flags = ["-fvisibility=default"] + (["-U__SIZEOF_INT128__"] if request.param == "portable" else [])
    return ctypes.CDLL(str(compile_shared([RUNTIME / "noise.c"], path, flags=flags)))


def philox(library, counter, key):
    out = WORDS()
    library.philox(WORDS(*counter), KEY(*key), out)
    return list(out)


def normals(library, key, k, task, count):
    out = (ctypes.c_double * count)()
    library.standard_normals(KEY(*key), ctypes.c_uint64(k), ctypes.c_uint64(task), out, count)
    return list(out)


def test_philox_gives_the_published_vectors(library):
    """Known answers of Random123 1.14, kat_vectors: philox 4x64 10."""
    ones = 2**64 - 1
    assert philox(library, [0] * 4, [0] * 2) == [
        0x16554D9ECA36314C,
        0xDB20FE9D672D0FDC,
        0xD7E772CEE186176B,
        0x7E68B68AEC7BA23B,
    ]
    assert philox(library, [ones] * 4, [ones] * 2) == [
        0x87B092C3013FE90B,
        0x438C3C67BE8D0224,
        0x9CC7D7C69CD777B6,
        0xA09CAEBF594F0BA0,
    ]


def test_philox_equals_numpys(library):
    random = np.random.default_rng(5)
    for _ in range(50):
        counter = [int(n) for n in random.integers(1, 2**63, 4)]
        key = [int(n) for n in random.integers(0, 2**63, 2)]
        before = [counter[0] - 1, *counter[1:]]  # NumPy adds one before it draws
        expected = np.random.Philox(counter=before, key=key).random_raw(4)
        assert philox(library, counter, key) == [int(n) for n in expected]


def test_normals_are_box_muller_of_successive_blocks(library):
    z = normals(library, [1, 2], 7, 3, 10)
    for i in range(0, 10, 2):
        block = philox(library, [i // 4, 7, 3, 0], [1, 2])
        u1, u2 = (((block[i % 4 + j] >> 11) + 0.5) * 2.0**-53 for j in range(2))
        radius = math.sqrt(-2.0 * math.log(u1))
        assert z[i] == pytest.approx(radius * math.cos(2 * math.pi * u2), rel=1e-14)
        assert z[i + 1] == pytest.approx(radius * math.sin(2 * math.pi * u2), rel=1e-14)


def test_a_shorter_draw_is_the_beginning_of_a_longer_one(library):
    longest = normals(library, [9, 9], 1, 1, 11)
    for count in range(1, 11):
        assert normals(library, [9, 9], 1, 1, count) == longest[:count]
