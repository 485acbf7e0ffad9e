"""One section of the evidence: what it claims, and how it is written."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from navfmu.report.claim import Claim
from navfmu.report.page import Page


@dataclass(frozen=True)
class Section:
    """What a module's ``run`` found. ``left_out`` says why nothing was measured; then nothing is claimed either."""

    claims: Sequence[Claim]
    write: Callable[[Page], None]
    left_out: str = ""


def illustrated(
    heading: str, claims: Sequence[Claim], picture: Callable[[], bytes], words: str, *table: Sequence
) -> Section:
    """A sensor's section: each claim with what was found and its limit, a ``table`` (head, rows) if there is one, and
    the picture, which ``words`` describe and which is drawn when the page is written.
    """

    def write(page: Page) -> None:
        page.heading(heading, 3)
        page.items(f"{claim.sentence}: {claim.finding} ({claim.limit})" for claim in claims)
        if table:
            page.table(*table)
        page.picture(picture(), words)

    return Section(claims, write)


def left_out(heading: str, reason: str) -> Section:
    """A section without data."""

    def write(page: Page) -> None:
        page.heading(heading)
        page.text(f"Left out: {reason}.")

    return Section((), write, reason)


def recorded(*needed: str, under: str = "") -> tuple[Path, str]:
    """The folder ``under`` that which NAVFMU_DATA names, and why nothing can be measured with it, "" if it can.

    ``needed`` are its files, of which a pattern stands for one at least.
    """
    if not (named := os.environ.get("NAVFMU_DATA")):
        return Path(), "the environment variable NAVFMU_DATA does not name a folder with recordings"
    folder = Path(named) / under
    missing = next((pattern for pattern in needed if not any(folder.glob(pattern))), None)
    return folder, f"{folder} has no {missing}" if missing else ""
