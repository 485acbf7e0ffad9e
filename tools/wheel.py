"""Build the one wheel: package, engine for five platforms, built FMUs and systems.

``python -m tools.wheel --out dist`` stages a copy of the package in a temporary folder, adds what the checkout builds
on demand (``navfmu/shipped``, ``navfmu/engine/native``) and runs pip there, so that the checkout itself stays clean.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from navfmu.engine.library import build_all

ROOT = Path(__file__).resolve().parent.parent
PACKAGED = tuple("c h so dll dylib fmu ssp ssv toml md txt xsd json j2 js css lark".split())
"""Endings of the files in the package that are not Python."""


def stage(folder: Path) -> None:
    """Copy the package and its metadata to an empty ``folder`` and build everything shipped into it."""
    skip = shutil.ignore_patterns("__pycache__", "shipped", "native")
    for package in ("navfmu", "navfmu_figures"):
        shutil.copytree(ROOT / package, folder / package, ignore=skip)
    for name in ("README.md", "LICENSE"):
        shutil.copy(ROOT / name, folder / name)
    data = ", ".join(f'"**/*.{ending}"' for ending in PACKAGED)
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    (folder / "pyproject.toml").write_text(
        f"{project}\n[tool.setuptools.package-data]\nnavfmu = [{data}]\n", encoding="utf-8"
    )

    shipped = folder / "navfmu" / "shipped"
    command = [sys.executable, str(ROOT / "build_fmus.py"), "--platforms", "all", "--no-twins", "--out", str(shipped)]
    subprocess.run(command, check=True, cwd=ROOT)
    for package in shipped.glob("*_*.ssp"):  # a system's own package holds its variants too
        if any(package.stem.startswith(f"{other.stem}_") for other in shipped.glob("*.ssp")):
            package.unlink()
    build_all(folder / "navfmu" / "engine" / "native")


def main() -> None:
    """Build the wheel and print its path and size."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=ROOT / "dist", help="folder for the wheel (default: dist)")
    out = parser.parse_args().out.resolve()
    with TemporaryDirectory(prefix="navfmu-wheel-") as folder:
        stage(Path(folder))
        pip = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", str(out), folder]
        subprocess.run(pip, check=True)
    wheel = max(out.glob("navfmu-*.whl"), key=lambda path: path.stat().st_mtime)
    print(f"{wheel} ({wheel.stat().st_size / 1e6:.1f} MB)")


if __name__ == "__main__":
    main()
