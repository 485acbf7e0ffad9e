"""The Windows binaries, run under wine, against the Linux ones."""

from __future__ import annotations

import platform

import numpy as np
import pytest

from navfmu.export.build import build
from tests import built
from tests.conformance import hosts, native

STEP, STEPS, EVERY = 0.01, 6000, 50
LINUX, WINDOWS = "x86_64-linux", "x86_64-windows"


@pytest.fixture(scope="module")
def drivers(tmp_path_factory):
    if platform.system() != "Linux" or platform.machine() != "x86_64":
        pytest.skip("wine runs Windows binaries for x86-64 on Linux for x86-64 only")
    hosts.require(native.wine() is not None, "wine64")
    folder = tmp_path_factory.mktemp("drivers")
    return {target: native.compile_driver(target, folder) for target in (LINUX, WINDOWS)}


@pytest.mark.slow
@pytest.mark.parametrize("name", ["imu", "navigator", "track"])
def test_windows_binary_gives_the_numbers_of_the_linux_binary(drivers, name, tmp_path):
    """Noise, filter and table reading: C libraries differ in the last place of log, cos and the like, nothing else."""
    (fmu,) = build([built.components()[name]], tmp_path, platforms=(LINUX, WINDOWS))
    linux, windows = (
        native.run(drivers[target], target, fmu, tmp_path, STEP, STEPS, EVERY) for target in (LINUX, WINDOWS)
    )
    assert linux.shape == windows.shape == (STEPS // EVERY, linux.shape[1])
    assert np.all(np.isfinite(linux))
    size = np.max(np.abs(linux), axis=0)
    assert np.count_nonzero(size) > 3
    assert np.all(np.abs(windows - linux) <= 1e-9 * size)
