"""Statistics over many runs by kind: one file each, all with a class ``Statistic`` (see ``report/kind.py``)."""
