"""What the plugin costs where no test asks for a system."""

from __future__ import annotations

HEAVY = ("numpy", "scipy", "pandas", "pyarrow", "pydantic", "matplotlib", "lxml", "fmpy", "rich", "click", "jinja2")
CONFTEST = f"""
import sys

def pytest_sessionfinish():
    loaded = [name for name in {HEAVY!r} if name in sys.modules]
    own = sorted(name for name in sys.modules if name.startswith("navfmu"))
    print()
    print("HEAVY", *loaded)
    print("OWN", *own)
"""


def lines(ended):
    return {line.split()[0]: line.split()[1:] for line in ended.out.splitlines() if line.startswith(("HEAVY", "OWN"))}


def test_nothing_heavy_is_imported_before_a_test_asks_for_a_system(folder):
    (folder.path / "conftest.py").write_text(CONFTEST)
    text = """
        import pytest

        def test_other():
            pass

        @pytest.mark.seeds("1-3")
        def test_system(system):
            with system("tracker.ssp") as s:
                s.run(1)
        """
    collected = lines(folder.pytest(text, "-s", "--collect-only"))
    assert collected["HEAVY"] == []
    assert collected["OWN"] == [
        "navfmu",
        "navfmu.campaign",
        "navfmu.campaign.seeds",
        "navfmu.errors",
        "navfmu.testing",
        "navfmu.testing.marks",
        "navfmu.testing.plugin",
    ]
    assert lines(folder.pytest(text, "-s", "-k", "other"))["HEAVY"] == []
    assert "numpy" in lines(folder.pytest(text, "-s", "-k", "seed2"))["HEAVY"]
