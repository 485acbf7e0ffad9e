"""Write the table of figures and its pictures into ``docs``: ``python -m tools.figures_page results/figures-thesis``.

The folder is what ``navfmu figures thesis`` has written.
"""

from __future__ import annotations

import json
import re
import shutil
import sys
from pathlib import Path

from navfmu.figures import Comparison

ROOT = Path(__file__).resolve().parent.parent
PAGE, PICTURES = ROOT / "docs" / "figures.md", ROOT / "docs" / "figures"
WRITTEN = re.compile(r"(<!-- written by .* -->\n\n)(.*)(<!-- end -->)", re.DOTALL)


def table(rows: list[dict]) -> str:
    """A section for each row: claim, figures, why they differ, picture."""
    parts = []
    for row in rows:
        found = [Comparison.restored(one) for one in row["comparisons"]]
        lines = [f"### {row['row']}: {row['claim']}", "", f"Source: {row['source']}.", ""]
        lines += ["| what | printed | ours | agrees at | verdict |", "|---|---|---|---|---|"]
        lines += [f"| {o.what} | {o.printed} | {o.finding} | {o.bounds} | {o.verdict} |" for o in found]
        lines += ["", *(f"- {o.what}: agrees there because {o.why}." for o in _once(found))]
        lines += [f"- **{o.what} differs**: {o.explanation}." for o in found if o.explanation]
        lines += [f"- {note}" for note in row["notes"]]
        lines += ["", f"![{row['words']}](figures/{row['row']}.png)", ""]
        parts.append("\n".join(lines))
    return "\n".join(parts)


def _once(found: list[Comparison]) -> list[Comparison]:
    """Of several with one reason the first."""
    return list({one.why: one for one in reversed(found)}.values())[::-1]


def main() -> None:
    """Write the page's part that is found, and the pictures."""
    folder = Path(sys.argv[1])
    rows = json.loads((folder / "figures.json").read_text(encoding="utf-8"))["rows"]
    failed = [row["row"] for row in rows if row["error"]]
    if failed:
        raise SystemExit(f"{folder}: {', '.join(failed)} failed; expected figures of all rows")
    text = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(WRITTEN.sub(lambda part: f"{part[1]}{table(rows)}\n{part[3]}", text), encoding="utf-8")
    PICTURES.mkdir(exist_ok=True)
    for row in rows:
        shutil.copy(folder / "rows" / f"{row['row']}.png", PICTURES)
    print(f"wrote {PAGE} and {len(rows)} pictures")


if __name__ == "__main__":
    main()
