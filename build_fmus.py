"""Build the FMUs of this repository: python build_fmus.py [NAME ...] [--platforms host|all] [--out dist]."""

from navfmu.export.__main__ import main

if __name__ == "__main__":
    main(prog_name="build_fmus.py")
