"""The report in a browser: filtered, sorted, looked into with the keyboard, printed; also with five thousand runs."""

from __future__ import annotations

import re
import time
from pathlib import Path

import numpy as np
import pandas
import pytest
from scipy.stats import binomtest

from navfmu.campaign import load_campaign, run_campaign
from navfmu.campaign.drawn import LIMIT, Drawn, drawn, stretches
from navfmu.campaign.page import page
from navfmu.campaign.story import story
from navfmu.report.packed import packed, unpacked
from navfmu.report.panel import Curve, Panel
from tests.campaign.test_conclusion import CAMPAIGN, FAULTS
from tests.components import systems
from tests.report.browser import Browser, needed

pytestmark = needed

ROWS = "[...document.querySelectorAll('#{id} .sheet .row')].map(r => [...r.children].map(c => c.textContent))"
OPEN = "document.getElementById('detail').open"
HEADING = "document.querySelector('#detail h2')?.textContent"


@pytest.fixture(scope="module")
def outcome(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page")
    only = FAULTS.partition('\n[[fault]]\nid = "held"')[0]
    (folder / "small.toml").write_text(only.format(value=0.5))
    (folder / "large.toml").write_text(only.format(value=40.0))
    (folder / "c.toml").write_text(CAMPAIGN.format(system=systems.tracker()))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("navfmu.campaign.pictured.PICTURED", 1)
        yield run_campaign(load_campaign(folder / "c.toml"), folder / "out", 2, workers="thread")


@pytest.fixture
def browser(outcome, tmp_path):
    with Browser(tmp_path) as browser:
        browser.open(outcome.report)
        yield browser
        assert browser.errors == []
        assert all(address.startswith(("file:", "data:", "blob:")) for address in browser.asked)


def rows(browser: Browser, name: str) -> list[list[str]]:
    """What is to be read in the rows of a table, in the order of the screen."""
    found = browser.value(ROWS.format(id=name))
    return found


def matrix_of(outcome) -> dict[tuple[str, str], str]:
    """R-1 in words, counted from the recordings."""
    held: dict[tuple[str, str], int] = {}
    for judged in outcome.runs:
        frame = pandas.read_parquet(outcome.folder / "runs" / judged.answer.recording)
        instants = frame["time"] if "time" in frame else frame.index
        values = frame["estimator.solution.length"].to_numpy()[instants >= 2.0 - 1e-9]
        place = judged.run.variant, judged.run.case.name
        held[place] = held.get(place, 0) + int(np.mean(values <= 8.0) >= 0.9)
    return {place: f"{'holds' if count >= 1.6 else 'VIOLATED'} {count}/4" for place, count in held.items()}


def test_the_matrix_shows_what_the_recordings_say(browser, outcome):
    found = {(row[0], row[1]): row[3] for row in rows(browser, "matrix")}
    assert found == matrix_of(outcome)


def choose(browser: Browser, table: str, label: str, text: str) -> None:
    browser.value(
        f"(() => {{ const s = document.querySelector('#{table} select[aria-label=\"{label}\"]');"
        f" s.value = [...s.options].find(o => o.textContent === '{text}').value;"
        " s.dispatchEvent(new Event('input', {bubbles: true})); })()"
    )


def test_the_matrix_is_filtered_by_words_and_choices(browser, outcome):
    browser.value("document.querySelector('#matrix input').focus()")
    browser.press("slow F10")
    left = rows(browser, "matrix")
    assert {(row[0], row[1]) for row in left} == {("slow", "small"), ("slow", "large")}
    assert browser.value("document.querySelector('#matrix output').textContent") == "2 of 6 rows"
    browser.value(
        "(i => { i.value = ''; i.dispatchEvent(new Event('input')); })(document.querySelector('#matrix input'))"
    )
    choose(browser, "matrix", "verdict", "violated somewhere")
    worst = {place for place, text in matrix_of(outcome).items() if text.startswith("VIOLATED")}
    seen = {(row[0], row[1]) for row in rows(browser, "matrix")}
    assert worst and worst <= seen and all("VIOLATED" in " ".join(row) for row in rows(browser, "matrix"))
    choose(browser, "matrix", "variant", "main")
    assert {row[0] for row in rows(browser, "matrix")} == {"main"}


def test_headings_sort_and_say_so(browser):
    def seeds() -> list[int]:
        number = browser.value(
            "[...document.querySelectorAll('#runs .head button')].findIndex(b => b.textContent === 'seed')"
        )
        return [int(row[number]) for row in rows(browser, "runs")]

    press = "[...document.querySelectorAll('#runs .head button')].find(b => b.textContent === 'seed').click()"
    browser.value(press)
    assert seeds() == sorted(seeds()) and seeds()[0] == 1
    browser.value(press)
    assert seeds() == sorted(seeds(), reverse=True) and seeds()[0] == 4
    found = browser.value("[...document.querySelectorAll('#runs [aria-sort]')].map(c => c.getAttribute('aria-sort'))")
    assert sorted(found)[0] == "descending" and found.count("none") == len(found) - 1


def test_with_the_keyboard_alone_one_comes_from_the_matrix_to_the_curves_and_back(browser, outcome):
    browser.value("document.querySelector('#matrix select:last-of-type').focus()")
    browser.press(*["Tab"] * (1 + len(rows(browser, "matrix")[0])))  # over the headings into the table
    assert browser.value("document.activeElement.closest('.sheet') !== null")
    browser.press("ArrowDown", "ArrowDown", "End", "ArrowLeft")
    place = browser.value("[document.activeElement.dataset.row, document.activeElement.dataset.column]")
    assert place == ["2", "3"]
    browser.press("Enter")
    browser.until(OPEN)
    row = rows(browser, "matrix")[2]
    assert browser.value(HEADING).startswith(f"R-1 in {row[0]}, {row[1]}: ")
    browser.press("Tab", "Enter")  # from the heading to its worst run
    browser.until("document.querySelectorAll('#detail .chart .main-svg').length > 0")
    group = next(g for g in outcome.cells if (g.variant, g.case, g.requirement.id) == (row[0], row[1], "R-1"))
    assert browser.value(HEADING) == f"{row[0]}, {row[1]}, seed {group.worst.run.seed}"
    browser.press("Escape")
    browser.until(f"!{OPEN}")
    assert browser.value("document.activeElement.dataset.column") == "3"
    assert browser.value("location.hash") == ""


def test_a_cell_tells_the_share_of_runs_that_its_number_can_show(browser, outcome):
    variant, case = rows(browser, "matrix")[0][:2]
    count = int(matrix_of(outcome)[variant, case].split()[1].partition("/")[0])
    interval = binomtest(count, 4).proportion_ci(method="wilson")
    browser.value("location.hash = '#cell/0/0'")
    browser.until(OPEN)
    words = browser.value("document.querySelector('#detail').innerText")
    assert f": {100 * interval.low:.0f} to {100 * interval.high:.0f} % of such runs hold (95 % interval)." in words
    assert f"held in {count} of 4 runs" in words


def test_a_run_shows_its_recording_and_its_command(browser, outcome):
    number = next(
        i for i, j in enumerate(outcome.runs) if (j.run.variant, j.run.case.name, j.run.seed) == ("main", "large", 3)
    )
    judged = outcome.runs[number]
    browser.value(f"location.hash = '#run/{number}'")
    browser.until("document.querySelectorAll('#detail .chart .main-svg').length > 0")
    assert browser.value("document.querySelector('#detail pre').textContent") == judged.run.experiment.command()
    frame = pandas.read_parquet(outcome.folder / "runs" / judged.answer.recording)
    expected = frame["estimator.solution.length"].to_numpy()
    drawn = np.array(browser.value("[...document.querySelector('#detail .chart').data[0].y]"))
    assert len(drawn) == len(expected) and np.abs(drawn - expected).max() <= 0.51 * np.ptp(expected) / 65534
    words = browser.value("document.querySelector('#detail').innerText")
    assert "jump" in words and "from 6" in words and "R-2" in words
    marks = browser.value("document.querySelector('#detail .chart').layout.shapes.map(s => [s.type, s.x0])")
    instants = frame["time"].to_numpy() if "time" in frame else frame.index.to_numpy()
    first = float(instants[(instants >= 2.0) & (expected > 8.0)][0])
    assert ["rect", 6] in marks and ["line", pytest.approx(first)] in marks
    buttons = browser.value("[...document.querySelectorAll('.modebar-btn')].map(b => b.dataset.title)")
    assert buttons and not any("loud" in title for title in buttons)  # nothing that sends data away


def test_a_link_to_a_run_opens_it(outcome, tmp_path):
    with Browser(tmp_path) as browser:
        browser.open(outcome.report, "#run/5")
        browser.until(OPEN)
        run = outcome.runs[5].run
        assert browser.value(HEADING) == f"{run.variant}, {run.case.name}, seed {run.seed}"
        browser.value("location.hash = '#run/99999'")
        browser.until(f"!{OPEN}")


def test_headings_are_listed_and_the_links_lead_somewhere(browser):
    links = browser.value("[...document.querySelectorAll('nav a')].map(a => [a.textContent, a.getAttribute('href')])")
    assert [text for text, _ in links][:3] == ["Conclusion", "Verdict matrix", "By lines of the FMEA"]
    for text, href in links:
        assert browser.value(f"document.querySelector('{href}').textContent") == text
    assert browser.value("new Set([...document.querySelectorAll('[id]')].map(e => e.id)).size") == browser.value(
        "document.querySelectorAll('[id]').length"
    )


def test_what_is_printed_fits_and_has_what_one_signs(browser, tmp_path):
    pages = re.findall(rb"/Type\s*/Page\b", browser.pdf(tmp_path / "report.pdf").read_bytes())
    assert 3 <= len(pages) <= 12
    browser.call("Emulation.setEmulatedMedia", media="print")
    browser.call("Emulation.setDeviceMetricsOverride", width=703, height=1000, deviceScaleFactor=1, mobile=False)
    seen = "getComputedStyle(document.querySelector('{0}')).display !== 'none'"
    assert browser.value(seen.format("table.sign")) and not browser.value(seen.format("#matrix"))
    assert browser.value("document.querySelector('.wide.paper tbody').getBoundingClientRect().height") > 50
    assert browser.value("document.querySelector('figure img').getBoundingClientRect().height") > 50
    assert browser.value("document.documentElement.scrollWidth") <= 703
    cut = "[...document.querySelectorAll('td')].filter(c => c.scrollWidth > c.clientWidth + 1).map(c => c.textContent)"
    assert browser.value(cut) == []


def test_a_dozen_requirements_are_printed_without_making_the_page_smaller(outcome, tmp_path):
    """A table that is wider than the paper makes the browser print everything in smaller letters."""
    tale = story(outcome, lambda order: drawn(outcome, order))
    ids = [f"GEOMETRY-{number}" for number in range(13)]
    tale["requirements"] = [tale["requirements"][0] | {"id": name} for name in ids]
    for group in tale["groups"]:
        group["cells"] = group["cells"][:1] * len(ids)
    for run in tale["runs"]:
        run["findings"] = run["findings"][:1] * len(ids)
    file = tmp_path / "report.html"
    file.write_text(page(tale, [], {"versions": {}}, [], []).html(), encoding="utf-8")
    with Browser(tmp_path) as browser:
        browser.open(file)
        browser.call("Emulation.setEmulatedMedia", media="print")
        browser.call("Emulation.setDeviceMetricsOverride", width=703, height=1000, deviceScaleFactor=1, mobile=False)
        assert browser.value("document.documentElement.scrollWidth") <= 703
        strips = "[...document.querySelectorAll('figure img.tall')].map(i => i.getBoundingClientRect().width / 990)"
        assert browser.value(strips) and min(browser.value(strips)) > 0.6  # of the size of their letters
        ends = "Math.max(...[...document.querySelectorAll('td')].map(c => c.getBoundingClientRect().right))"
        assert browser.value(ends) <= 703


@pytest.mark.parametrize("width", [400, 700, 1000])
def test_a_narrow_window_shows_the_whole_width(browser, width):
    """Wide tables move in a frame of their own; the page itself does not."""
    browser.call("Emulation.setDeviceMetricsOverride", width=width, height=800, deviceScaleFactor=1, mobile=False)
    assert browser.value("document.documentElement.scrollWidth") <= width


def test_without_scripts_the_tables_are_there(outcome, tmp_path):
    with Browser(tmp_path) as browser:
        browser.call("Emulation.setScriptExecutionDisabled", value=True)
        browser.call("Page.navigate", url=outcome.report.resolve().as_uri())
        time.sleep(1.0)
        browser.call("Emulation.setScriptExecutionDisabled", value=False)
        assert browser.value("document.querySelector('.wide.paper').getBoundingClientRect().height") > 50
        assert "Scripts are switched off" in browser.value("document.querySelector('noscript').textContent")


# ---- many runs ------------------------------------------------------------------------------------------------------

RUNS, SEEDS = 5000, 2


def many() -> dict:
    """The story of 5 000 runs: 2 variants, 1 250 cases along an axis, 2 seeds."""
    instants = np.arange(2101.0)
    noise = np.random.default_rng(0).normal(size=(7, 2101)).cumsum(axis=1)

    def curves(number: int) -> str:
        band = Curve("3 sigma", instants, 3 * np.abs(noise[1]), "band")
        errors = Curve("error", instants, noise[number % 7] + number, peaks=True), band
        track = Curve("a", noise[3], noise[4]), Curve("b", noise[5], noise[6])
        panels = [Panel("x", "time, s", "m", errors), Panel("track", "", "", track, timed=False, equal=True)]
        return packed(panels, {"windows": [], "end": 2100.0}, stretches(RUNS))

    requirement = {
        "id": "R-1", "severity": "", "sentence": "a.x <= 900 m always", "description": "", "signal": "a.x", "unit": "m",
        "runs": 100.0, "quantile": None, "quantity": ["a.x", " at its worst time", "worst x"], "bounds": [None, 900.0],
    }  # fmt: skip
    cases, groups, runs = [], [], []
    for number in range(RUNS // 2 // SEEDS):
        fault = {"id": "f", "fmea": f"F{number % 47 + 1}", "description": "", "components": ["a"], "start": 1.0}
        fault |= {"cells": ["f", "a.x", f"bias (value = {number})", "from 1"]}
        cases.append(
            {
                "name": f"case {number}",
                "written": "case",
                "description": "",
                "values": [float(number)],
                "changed": "",
                "faults": [fault],
            }
        )
    for variant in ("main", "other"):
        for number, case in enumerate(cases):
            bad = number > 900
            places = [len(runs), len(runs) + 1]
            groups.append({"variant": variant, "case": number, "runs": places, "cells": [{
                "passed": not bad, "verdict": "violated" if bad else "holds",
                "held": 0 if bad else 2, "total": 2, "distinct": 2, "interval": [0.0, 100.0],
                "sentence": "held", "worst": places[0], "rank": [float(not bad), 0.0, 0.0 if bad else 100.0],
            }]})  # fmt: skip
            for seed in range(SEEDS):
                finding = {"held": not bad, "inside": 100.0 - 50.0 * bad, "share": "50.0 %", "worst": float(number)}
                finding |= {"text": f"{number} m", "at": 7.0, "first": None, "missing": 0}
                command = f"navfmu run system.ssp --seed {seed + 1} {300 * 'x'}"
                runs.append({
                    "variant": variant, "case": case["name"], "values": [float(number)], "seed": seed + 1,
                    "error": None, "findings": [finding], "notes": [], "idle": {}, "not_finite": {},
                    "command": command, "recording": "runs/x.parquet", "faults": [case["faults"][0]["cells"]],
                    "events": [], "curves": curves(number % 50),
                })  # fmt: skip
    return {
        "name": "many", "description": "", "variants": ["main", "other"], "components": {"main": ["a"], "other": ["a"]},
        "seeds": "1-2", "stop": 2100.0, "steps": [0.01], "algorithm": "jacobi", "axes": ["bias (m)"],
        "requirements": [requirement], "cases": cases, "searched": [], "groups": groups, "order": list(range(RUNS)),
        "notes": [], "remarks": [], "idle": [], "thresholds": [], "passed": False, "runs": runs,
        "noticing": [],
    }  # fmt: skip


@pytest.fixture(scope="module")
def thousands(tmp_path_factory) -> Path:
    file = tmp_path_factory.mktemp("many") / "report.html"
    file.write_text(page(many(), [("runs", str(RUNS))], {"versions": {}}, [], []).html(), encoding="utf-8")
    return file


@pytest.mark.slow
def test_five_thousand_runs_can_be_read(thousands, tmp_path):
    assert thousands.stat().st_size < 2 * LIMIT
    with Browser(tmp_path) as browser:
        begin = time.monotonic()
        browser.open(thousands)
        assert time.monotonic() - begin < 20.0
        assert browser.value("document.querySelectorAll('*').length") < 30_000
        assert len(rows(browser, "runs")) < 100
        begin = time.monotonic()
        browser.value("(v => { v.scrollTop = v.scrollHeight; })(document.querySelector('#runs .view'))")
        browser.until(
            "[...document.querySelectorAll('#runs .sheet .row')].pop().getAttribute('aria-rowindex') === '5001'"
        )
        browser.value("document.querySelector('#runs input').focus()")
        browser.press("F47 main")
        expected = sum(number % 47 == 46 for number in range(1250)) * SEEDS
        assert browser.value("document.querySelector('#runs output').textContent") == f"{expected} of 5000 rows"
        browser.value("location.hash = '#run/4999'")
        browser.until("document.querySelectorAll('#detail .chart .main-svg').length > 0")
        assert time.monotonic() - begin < 20.0
        assert browser.errors == []


def test_the_page_of_many_runs_says_what_is_left_out(thousands):
    text = thousands.read_text(encoding="utf-8")
    assert "these are the worst 400 of 2500 rows; all are in verdicts.csv" in text
    assert text.count('id="curves-') == RUNS and "No run is left out." in text


def test_curves_beyond_the_limit_are_left_out_from_the_last_on(outcome, monkeypatch):
    order = list(range(len(outcome.every)))[::-1]
    whole = drawn(outcome, order)
    monkeypatch.setattr("navfmu.campaign.drawn.LIMIT", sum(len(whole[n].curves) for n in order[:5]))
    some = drawn(outcome, order)
    assert [bool(one.curves) for one in some] == [number in order[:5] for number in range(len(order))]
    assert [one.events for one in some] == [one.events for one in whole]
    assert isinstance(some[0], Drawn)


def test_the_script_unpacks_what_the_package_packs(browser, outcome):
    (text,) = re.findall(r'id="curves-0">([^<]*)<', outcome.report.read_text())
    about, columns = unpacked(text)
    found = browser.value("unpacked(document.getElementById('curves-0').textContent)")
    assert found["panels"] == about["panels"]
    for mine, theirs in zip(columns, found["columns"], strict=True):
        assert [None if np.isnan(v) else v for v in mine] == theirs
