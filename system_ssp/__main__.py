"""``python -m system_ssp``: write each system's documents (.ssd, .ssv) beside its system.py, from the FMUs in dist/."""

from __future__ import annotations

from pathlib import Path

from navfmu.ssp.discovery import sources

HERE = Path(__file__).resolve().parent

if __name__ == "__main__":
    for folder, source in sources(HERE, HERE.parent / "dist").items():
        for path in source.write(folder):
            print(path.relative_to(HERE.parent))
