"""Ctrl-C while the command line is being imported: one sentence and the code 130, whatever the import makes of it."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from tests.components import systems

pytestmark = pytest.mark.skipif(os.name == "nt", reason="signals")
CODE = """
import os, signal, sys

class Press:
    @staticmethod
    def find_spec(name, path=None, target=None):
        if name == module:
            os.kill(os.getpid(), signal.SIGINT)

from navfmu.__main__ import main
module = sys.argv.pop(1)
sys.meta_path.insert(0, Press)
main()
"""
MODULES = ("click", "navfmu.cli.main", "navfmu.errors", "navfmu.cli.run", "navfmu.system.experiment", "numpy", "pandas")


@pytest.mark.parametrize("module", MODULES)
def test_during_the_import_of(module):
    words = ["run", str(systems.tracker()), "--stop", "1"]
    done = subprocess.run([sys.executable, "-c", CODE, module, *words], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "navfmu: interrupted\n")


@pytest.mark.parametrize("module", ["navfmu.export.build", "navfmu.export.discovery", "navfmu.terminal.progress"])
def test_while_fmus_are_built(module):
    """It was "Aborted!", with the code 1."""
    code = CODE.replace("navfmu.__main__", "navfmu.export.__main__")
    done = subprocess.run([sys.executable, "-c", code, module], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "navfmu: interrupted\n")


def test_the_package_itself_imports_nothing():
    code = "import sys; before = set(sys.modules); import navfmu; print(*sorted(set(sys.modules) - before))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "navfmu\n"


def test_what_the_package_gives_is_what_it_promises():
    import navfmu

    assert all(getattr(navfmu, name) for name in navfmu.__all__)
    with pytest.raises(AttributeError, match="no attribute 'Sytem'"):
        navfmu.Sytem  # noqa: B018
