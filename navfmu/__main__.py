"""``python -m navfmu``."""

from navfmu.cli.main import main

if __name__ == "__main__":
    main()
