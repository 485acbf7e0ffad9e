"""All benchmarks: ``python -m benchmarks [benchmarks.json]``; exit code 1 when a claim is missed."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

from benchmarks import NAMES
from benchmarks.contest import show, write

contests = [contest for name in NAMES for contest in importlib.import_module(f"benchmarks.{name}").run()]
show(contests)
if len(sys.argv) > 1:
    write(contests, Path(sys.argv[1]))
sys.exit(0 if all(claim.holds for contest in contests for claim in contest.claims) else 1)
