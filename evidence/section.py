"""One section of the evidence: what it claims, and how it is written."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from navfmu.report.claim import Claim
from navfmu.report.page import Page


@dataclass(frozen=True)
class Section:
    """What a module's ``run`` found. ``left_out`` says why nothing was measured; then nothing is claimed either."""

    claims: Sequence[Claim]
    write: Callable[[Page], None]
    left_out: str = ""


def left_out(heading: str, reason: str) -> Section:
    """A section without data."""

    def write(page: Page) -> None:
        page.heading(heading)
        page.text(f"Left out: {reason}.")

    return Section((), write, reason)
