"""Build the FMUs and systems: python build_fmus.py [NAME ...] [--platforms host|all] [--out dist]."""

from pathlib import Path

from navfmu.export.__main__ import main

if __name__ == "__main__":
    here = Path(__file__).parent
    main(prog_name="build_fmus.py", default_map={"folder": str(here / "fmus"), "systems": str(here / "system_ssp")})
