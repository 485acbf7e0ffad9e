"""``python -m benchmarks.exporter [FILE.json]``."""

from __future__ import annotations

from benchmarks.contest import main
from benchmarks.exporter.contests import run

main(run)
