"""What pytest calls: the fixture ``system``, its marks and option, and what is added to a test that failed."""

from __future__ import annotations

import ast
import inspect
import os
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from navfmu.errors import NavfmuError
from navfmu.testing.marks import MARKS, Setting, settings

if TYPE_CHECKING:
    from navfmu.testing.bench import Bench
    from navfmu.testing.logbook import Logbook

OPTION = "--navfmu-artifacts"
LOGBOOK: pytest.StashKey[Logbook] = pytest.StashKey()


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("navfmu", "systems of FMUs")
    text = "Folder for plots and recordings of failed tests; default: navfmu/ in pytest's temporary folder."
    group.addoption(OPTION, dest="navfmu_artifacts", metavar="DIR", default=None, help=text)


def pytest_configure(config: pytest.Config) -> None:
    for line in MARKS.values():
        config.addinivalue_line("markers", line)
    given = config.option.navfmu_artifacts
    if given is not None:
        folder = config.option.navfmu_artifacts = os.path.abspath(given)  # workers may run elsewhere
        if not given.strip() or (os.path.lexists(folder) and not os.path.isdir(folder)):
            raise pytest.UsageError(f"{OPTION} {given!r}: expected a folder, or the name of a new one")


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "system" not in metafunc.fixturenames:
        return

    def arguments(name: str) -> tuple[Any, ...] | None:
        mark = metafunc.definition.get_closest_marker(name)
        return None if mark is None else mark.args

    try:
        every = settings(arguments)
    except NavfmuError as error:
        pytest.fail(f"{metafunc.definition.nodeid}: {error}", pytrace=False)
    if every != [Setting()]:
        metafunc.parametrize("system", every, indirect=True, ids=[setting.id for setting in every])


class Systems:
    """What a test gets as ``system``: called, it puts one on the test bench."""

    def __init__(self, setting: Setting, logbook: Logbook, folder: Path) -> None:
        self.benches: list[Bench] = []
        self._setting, self._logbook, self._folder = setting, logbook, folder

    def __call__(self, name: str | os.PathLike, variant: str | None = None, **given: Any) -> Bench:
        """A system by its path, also beside the test, or a shipped one by its name.

        ``parameters``, ``twins``, ``strict``, and what else :meth:`navfmu.System.run` takes are keywords.
        """
        __tracebackhide__ = True
        from navfmu.testing.bench import Bench

        self.benches.append(Bench(name, variant, self._setting, self._logbook, self._folder, given))
        return self.benches[-1]

    def __repr__(self) -> str:
        return "<systems of FMUs>"


@pytest.fixture
def system(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Systems]:
    """A function that puts a system on the test bench.

    def test_gps(system):
        with system("backup_navigator", variant="scanning") as s:
            s.fault("gps.jammed", at=300)
            r = s.run(2100)
        assert r["evaluation.horizontal_error"].quantile(0.95) < 926
    """
    from navfmu.testing.logbook import Logbook

    def folder() -> Path:
        given = request.config.option.navfmu_artifacts
        return Path(given) if given is not None else tmp_path_factory.getbasetemp() / "navfmu"

    logbook = request.node.stash[LOGBOOK] = Logbook(folder, request.node.nodeid)
    system = Systems(getattr(request, "param", Setting()), logbook, request.path.parent)
    yield system
    logbook.clear()
    if not logbook.failed:
        try:
            for bench in system.benches:
                bench.close()
        except NavfmuError as error:
            pytest.fail(str(error), pytrace=False)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo) -> Iterator[None]:
    """A failed test says what was run, how to repeat it, and where its plot is."""
    report = yield
    logbook = item.stash.get(LOGBOOK, None)
    if report.failed and logbook is not None:
        logbook.failed = True
        text = logbook.story(_texts(item))
        if text and hasattr(report.longrepr, "addsection"):
            report.longrepr.addsection("navfmu", text)
        elif text:
            report.sections.append(("navfmu", text))
    return report


def _texts(item: pytest.Item) -> list[str]:
    """The texts in the code of a test: among them are the names of the signals that it looks at."""
    try:
        tree = ast.parse(textwrap.dedent(inspect.getsource(item.function)))
    except (AttributeError, OSError, TypeError, SyntaxError):
        return []
    return [node.value for node in ast.walk(tree) if isinstance(node, ast.Constant) and isinstance(node.value, str)]
