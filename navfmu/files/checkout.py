"""Which commit a file is of, where it lies in a git checkout."""

from __future__ import annotations

import subprocess
from pathlib import Path

WAIT = 20.0  # s


def commit_of(path: str | Path) -> str:
    """A sentence on the commit of a file or folder; "" where there is no checkout, or no git."""
    path = Path(path).resolve()
    folder = path if path.is_dir() else path.parent
    head = _git(folder, "rev-parse", "HEAD")
    if not head:
        return ""
    if not _git(folder, "ls-files", "--", str(path)):
        return f"not part of the checkout in which it lies (commit {head})"
    changed = _git(folder, "status", "--porcelain", "--", str(path))
    return f"commit {head}{', and changed since' if changed else ''}"


def _git(folder: Path, *words: str) -> str:
    try:
        done = subprocess.run(
            ["git", *words],
            cwd=folder,
            capture_output=True,
            text=True,
            encoding="utf-8",
            errors="replace",
            timeout=WAIT,
        )
    except (OSError, subprocess.SubprocessError):
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""
