"""The package knows no system by name: what it records, draws and counts stands in a file beside the system."""

from __future__ import annotations

import ast
import re
from pathlib import Path

from system_ssp.backup_navigator.system import COMPONENTS

PACKAGE = Path(__file__).parents[1] / "navfmu"
NAMES = re.compile(rf"({'|'.join((*COMPONENTS, 'backup_navigator'))})(\..*)?")


def names_in(source: str) -> list[str]:
    """Texts in code that are names of a shipped system, its components or their signals, or begin with one.

    Docstrings, help and messages may give examples: a text with a space is for people and nothing looks it up.
    """
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and NAMES.fullmatch(node.value):
            found.append(node.value)
    return found


def test_no_module_names_a_component_of_a_shipped_system():
    files = sorted(PACKAGE.rglob("*.py"))
    assert len(files) > 100
    wrong = [f"{file}: {name}" for file in files for name in names_in(file.read_text(encoding="utf-8"))]
    assert not wrong, "\n".join(wrong)


def test_the_check_finds_what_the_package_once_held():
    once = (
        'NAVIGATION = ("evaluation", "navigator")\n'
        'ERROR = "evaluation.horizontal_error"\n'
        'pairs = [f"evaluation.{axis}_error" for axis in axes]\n'
        'count = system.value("dme.station_count")\n'
    )
    names = {"evaluation", "navigator", "evaluation.horizontal_error", "evaluation.", "dme.station_count"}
    assert set(names_in(once)) == names
    assert names_in("raise Error(f\"{name} is no signal, such as 'imu.reading'\")") == []


def test_templates_name_none_either():
    pattern = re.compile(rf"\b({'|'.join(COMPONENTS)})\.[a-z]")
    for file in PACKAGE.rglob("*.j2"):
        assert not pattern.search(file.read_text(encoding="utf-8")), file
