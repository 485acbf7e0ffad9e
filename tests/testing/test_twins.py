"""Components of a system in Python: the same numbers, and a debugger sees the model."""

from __future__ import annotations

import bdb
import inspect
import sys
from shlex import split

import numpy as np
import pytest
from click.testing import CliRunner

from navfmu import System
from navfmu.cli.main import main
from navfmu.errors import NavfmuError
from navfmu.export.twin import build_twin
from navfmu.system import shipped
from navfmu.testing.twins import with_twins
from tests.components import Estimator, Lag, systems


def files_of(system) -> set[str]:
    """The files of the Python code that a run goes through."""
    seen = set()
    sys.settrace(lambda frame, *_: seen.add(frame.f_code.co_filename))
    try:
        system.run(stop=1.0)
    finally:
        sys.settrace(None)
    return seen


@pytest.fixture(scope="module")
def native():
    return System.load(systems.tracker(), variant="slow")


def test_a_class_runs_from_the_file_that_it_stands_in(native):
    twin = with_twins(native, {"estimator": Estimator})
    file = sys.modules[Estimator.__module__].__file__
    assert file in files_of(twin) and file not in files_of(native)
    expected, found = native.run(stop=10, seed=3), twin.run(stop=10, seed=3)
    np.testing.assert_allclose(found.astype(float), expected.astype(float), rtol=1e-12, atol=1e-12)


class Debugger(bdb.Bdb):
    """Stops where it is told, and looks at what is there."""

    def __init__(self) -> None:
        super().__init__()
        self.seen: list[tuple[str, float]] = []

    def user_line(self, frame) -> None:
        if self.break_here(frame):
            self.seen.append((frame.f_code.co_name, float(frame.f_locals["self"].gain)))
        self.set_continue()


def test_a_breakpoint_in_the_file_of_a_model_holds(native):
    lines, first = inspect.getsourcelines(Estimator.update)
    line = first + next(number for number, text in enumerate(lines) if "estimate =" in text)
    debugger = Debugger()
    assert debugger.set_break(inspect.getfile(Estimator), line) is None
    debugger.runcall(with_twins(native, {"estimator": Estimator}).run, stop=1.0)
    assert debugger.seen == 10 * [("update", 0.01)]  # of the variant slow; a measurement each 0.1 s


def test_by_its_name_it_is_the_twin_that_was_built(native, tmp_path, monkeypatch):
    build_twin(Lag, tmp_path / "python", pictures=False)
    monkeypatch.setattr(shipped, "folders", lambda: [tmp_path])
    twin = with_twins(native, ["lag"])
    expected, found = native.run(stop=10, seed=3), twin.run(stop=10, seed=3)
    np.testing.assert_allclose(found.astype(float), expected.astype(float), rtol=1e-12, atol=1e-12)
    assert any("components" in file and "lag_" in file for file in files_of(twin))


def test_what_there_is_not_is_a_sentence(native, tmp_path, monkeypatch):
    monkeypatch.setattr(shipped, "folders", lambda: [tmp_path])
    with pytest.raises(NavfmuError, match=r"no python/lag.fmu in the folder of built FMUs.*twins=\{'lag': ITS_CLASS\}"):
        with_twins(native, ["lag"])
    with pytest.raises(NavfmuError, match="there is no component 'lga'; did you mean 'lag'"):
        with_twins(native, ["lga"])
    with pytest.raises(NavfmuError, match="'lag' is no list of components"):
        with_twins(native, "lag")


def test_a_failed_test_names_the_twins_and_repeats_the_native_run(folder):
    ended = folder.pytest(
        """
        from tests.components import Estimator, Lag

        def test_bad(system):
            with system("tracker.ssp", twins={"estimator": Estimator, "lag": Lag}) as s:
                r = s.run(1, seed=2)
            assert r["lag.y"].max() < 0
        """
    )
    assert ended.counts == {"failed": 1}
    assert " twin " not in ended.row("test_bad", "repeat") and "tracker.ssp" in ended.row("test_bad", "repeat")
    section = ended.of("test_bad").split(" navfmu -")[1]
    assert "twin       estimator\ntwin       lag\n" in section
    done = CliRunner().invoke(main, split(ended.row("test_bad", "repeat"))[1:])
    assert done.exit_code == 0, done.output
