"""Wide tables fit: in the window and on paper, measured in a browser where one is installed."""

from __future__ import annotations

import json
import re
import subprocess

import pytest

from navfmu.report.page import Page
from tests.report.browser import PROGRAM, needed

PAPER = 700  # px: the width of A4 between margins of 12 mm
MEASURE = """
<script>
const cut = [], broken = [];
for (const cell of document.querySelectorAll("th, td")) {
  const box = cell.closest("div").getBoundingClientRect(), own = cell.getBoundingClientRect();
  const text = document.createRange();
  text.selectNodeContents(cell);
  const word = !/ /.test(cell.textContent) && cell.className !== "long";
  if (word && text.getClientRects().length > 1) broken.push(cell.textContent);
  if (own.right > box.right + 1 || cell.scrollWidth > cell.clientWidth + 1) cut.push(cell.textContent);
}
const page = document.documentElement.scrollWidth;
document.title = JSON.stringify({cut: cut, broken: broken, window: window.innerWidth, page: page});
</script>
"""


def sweep_page() -> str:
    """The widest table that the project prints: signals over nine step sizes."""
    steps = (0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
    page = Page("Communication step size")
    page.table(
        ["signal", "unit", "algorithm", *(f"{step:g} s" for step in steps), "slope", "algorithms apart"],
        [
            [f"navigator.solution.velocity_n[{i}]", "m/s", "gauss_seidel", *["6.88e-16"] * len(steps), "0.72", "0.271"]
            for i in range(1, 4)
        ],
    )
    return page.html()


def findings_page() -> str:
    """A table whose last column wants all the room."""
    page = Page("Findings")
    page.table(
        ["requirement", "variant", "case", "verdict", "seen"],
        [["ALT-1", "imu_consumer", "pilot_blocked", "VIOLATED", "held in 0 of 10 runs; inside for a while " * 6]] * 3,
    )
    return page.html()


def measured(html: str, width: int, folder) -> dict:
    file = folder / "page.html"
    file.write_text(html.replace("</body>", MEASURE + "</body>"), encoding="utf-8")
    flags = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking", "--hide-scrollbars")
    assert PROGRAM is not None, "there is no chromium"
    where = (f"--user-data-dir={folder / 'profile'}", f"--window-size={width},1000", "--dump-dom", file.as_uri())
    done = subprocess.run([PROGRAM, *flags, *where], capture_output=True, text=True, timeout=120)
    return json.loads(re.search(r"<title>(.*?)</title>", done.stdout)[1].replace("&quot;", '"'))


@needed
@pytest.mark.parametrize(("medium", "width"), [("screen", 1200), ("print", PAPER)])
@pytest.mark.parametrize("page", [sweep_page, findings_page])
def test_a_wide_table_is_shown_whole(page, medium, width, tmp_path):
    html = page()
    if medium == "print":
        assert html.count("@media print") == 1
        html = html.replace("@media print", "@media all")
    seen = measured(html, width, tmp_path)
    assert seen["window"] == width
    assert seen["cut"] == []
    assert seen["broken"] == []
    assert seen["page"] <= width
