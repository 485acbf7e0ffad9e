"""``python -m navfmu``."""

from navfmu.cli import main

if __name__ == "__main__":
    main()
