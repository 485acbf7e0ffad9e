"""What the exporter makes of large models, against loops written by hand in C and compiled with the same flags.

cases.py has the models and loops.c the same by hand; translated.py is a model on its way through the exporter,
contests.py measures and says what is claimed.
"""

from benchmarks.exporter.contests import run

__all__ = ["run"]
