"""Pictures by kind: one file each, all with a class ``Picture`` (see ``report/kind.py``)."""
