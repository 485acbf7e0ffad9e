"""The last section of every report: what is needed to repeat it."""

from __future__ import annotations

import json
from typing import Any

from navfmu.report.page import Page


def section(page: Page, provenance: dict[str, Any]) -> None:
    """Versions, hashes, seeds and the command."""
    page.heading("To repeat this")
    if provenance.get("command"):
        page.code(provenance["command"])
    versions = provenance.get("versions", {})
    page.text(", ".join(f"{name} {version}" for name, version in versions.items()))
    inner = Page("")
    inner.code(json.dumps({k: v for k, v in provenance.items() if k not in ("command", "versions")}, indent=2))
    page.folded("Hashes, seeds and parameters", inner)
