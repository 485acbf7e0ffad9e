"""An FMU on disk: its description, its units, and the names and values of its variables."""
