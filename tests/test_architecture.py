"""What may import what, as docs/architecture.md says; imports inside functions and for type hints count too."""

from functools import cache
from graphlib import CycleError, TopologicalSorter

import grimp
import pytest

ROOMS = (  # of the package, from the ground up: each may use what stands before it
    "errors",
    "constants",
    "place",
    "files",
    "fmi",
    "ssp",
    "terminal",
    "report",
    "derivatives",
    "repetition",
    "export",
    "expressions",
    "faults",
    "engine",
    "system",
    "sabotage",
    "satellite",
    "recorded",
    "calibration",
    "navaids",
    "sweep",
    "campaign",
    "analysis",
    "figures",
    "testing",
    "cli",
    "__main__",
)


ABOVE_COMPONENTS = ("navfmu.engine", "navfmu.system", "navfmu.ssp", "evidence", "benchmarks", "tests", "system_ssp")
NOT_NUMPY = tuple(
    f"navfmu.{room}" for room in ROOMS if room not in ("errors", "constants", "place", "derivatives", "repetition")
)


FIGURES = "navfmu_figures.thesis"
OF_CHECKOUTS = ("models", "fmus", "interpreted", "evidence", "benchmarks", "tests", "system_ssp", "tools")


@cache
def graph():
    folders = ("navfmu", FIGURES, *OF_CHECKOUTS)
    return grimp.build_graph(*folders, cache_dir=None)


def imports(package: str) -> list[tuple[str, str]]:
    """All imports in a package, (importer, imported)."""
    inside = [m for m in graph().modules if m == package or m.startswith(f"{package}.")]
    return [(m, other) for m in inside for other in graph().find_modules_directly_imported_by(m)]


def room(module: str) -> str:
    return module.split(".")[1] if "." in module else ""


def test_every_room_stands_in_the_plan_and_uses_only_what_stands_below_it():
    assert {room(m) for m in graph().modules if m.startswith("navfmu.")} == set(ROOMS)
    wrong = [
        f"{importer} imports {imported}"
        for importer, imported in imports("navfmu")
        if importer != "navfmu" and imported.startswith("navfmu.")
        if ROOMS.index(room(imported)) > ROOMS.index(room(importer))
    ]
    assert not wrong, "\n".join(wrong)


def test_no_module_of_the_package_needs_itself():
    edges = {}
    for importer, imported in imports("navfmu"):
        if importer != "navfmu":  # the front door: it leads to what is deepest in the house
            edges.setdefault(importer, set()).add(imported)
    assert len(edges) > 50
    try:
        list(TopologicalSorter(edges).static_order())
    except CycleError as error:
        pytest.fail(f"imports go round: {' <- '.join(error.args[1])}")


@pytest.mark.parametrize(
    ("package", "forbidden"),
    [
        ("models", ("fmus", "interpreted", *NOT_NUMPY, "evidence", "benchmarks", "tests", "system_ssp")),
        ("fmus", ("interpreted", *ABOVE_COMPONENTS)),
        ("interpreted", ABOVE_COMPONENTS),
        ("navfmu", (*OF_CHECKOUTS, FIGURES)),
        (FIGURES, (*OF_CHECKOUTS, "navfmu.system.shipped")),  # FMUs are those that a row declares
        ("system_ssp", ("models", "evidence", "benchmarks", "tests")),
        ("evidence", ("tests",)),
        ("benchmarks", ("tests",)),
        ("tools", ("tests",)),
    ],
)
def test_data_flows_downwards_only(package, forbidden):
    assert imports(package)
    wrong = [
        f"{importer} imports {imported}"
        for importer, imported in imports(package)
        if any(imported == f or imported.startswith(f"{f}.") for f in forbidden)
    ]
    assert not wrong, "\n".join(wrong)
