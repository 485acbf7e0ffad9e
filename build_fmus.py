"""Build the FMUs and systems: python build_fmus.py [NAME ...] [--platforms host|all] [--out dist]."""

from pathlib import Path

from navfmu.export.__main__ import main

if __name__ == "__main__":
    here = Path(__file__).parent
    folders = [str(here / "fmus"), str(here / "interpreted")]
    main(prog_name="build_fmus.py", default_map={"folders": folders, "systems": str(here / "system_ssp")})
