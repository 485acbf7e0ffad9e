"""What may import what, as docs/architecture.md says; imports inside functions and for type hints count too."""

import ast
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


def modules(folder: str) -> dict[str, Path]:
    """Modules of a package by their dotted name."""
    files = {file.relative_to(ROOT).with_suffix("").parts: file for file in (ROOT / folder).rglob("*.py")}
    return {".".join(parts).removesuffix(".__init__"): file for parts, file in files.items()}


def imports(file: Path) -> set[str]:
    """Dotted names that a file imports; ``from a import b`` gives both ``a`` and ``a.b``."""
    found = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{file}: relative import"
            found |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def test_no_module_of_the_package_needs_itself():
    known = modules("navfmu")
    packages = {name for name, file in known.items() if file.name == "__init__.py"}
    graph = {}
    for name, file in known.items():
        if name == "navfmu":
            continue  # the front door: it leads to what is deepest in the house
        targets = imports(file) & set(known) - {name, "navfmu"}
        # "from package import module" needs the module; the package only where the name is one of its own
        graph[name] = {t for t in targets if not (t in packages and any(o.startswith(f"{t}.") for o in targets))}
    assert len(graph) > 50
    try:
        list(TopologicalSorter(graph).static_order())
    except CycleError as error:
        pytest.fail(f"imports go round: {' <- '.join(error.args[1])}")


@pytest.mark.parametrize(
    ("folder", "forbidden"),
    [
        ("models", ("fmus", "navfmu", "evidence", "benchmarks", "tests", "system_ssp")),
        ("fmus", ("navfmu.engine", "navfmu.system", "navfmu.ssp", "evidence", "benchmarks", "tests", "system_ssp")),
        ("navfmu", ("models", "fmus", "evidence", "benchmarks", "tests", "system_ssp", "tools")),
        ("system_ssp", ("models", "evidence", "benchmarks", "tests")),
        ("evidence", ("tests",)),
        ("benchmarks", ("tests",)),
        ("tools", ("tests",)),
    ],
)
def test_data_flows_downwards_only(folder, forbidden):
    found = modules(folder)
    assert found
    for name, file in found.items():
        wrong = [i for i in imports(file) if any(i == f or i.startswith(f"{f}.") for f in forbidden)]
        assert not wrong, f"{name} imports {', '.join(sorted(wrong))}"
