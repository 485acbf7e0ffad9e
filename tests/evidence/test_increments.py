"""Titles and verdicts of the pictures of increments and of ring lasers follow the data."""

import numpy as np
import pytest

from evidence.sensors import increments, ring_laser
from evidence.sensors.increments import AROUND, LEVELS, RECTIFICATION, SAMPLES, Increments
from evidence.sensors.ring_laser import END, HOUR, LOCK_IN, OFF, ON, RATES, SEEDS, SHOWN, Rings
from models.inertial import ring_laser as model
from navfmu.report.page import Page


def made(kind, **found):
    """What a class of the evidence has when this was found."""
    result = kind()
    vars(result).update(found)
    return result


def honest_increments():
    """What an imu without any mistake would give."""
    left = np.array([increments.response(m, 2 * np.pi / AROUND) for m in SAMPLES])
    rng = np.random.default_rng(1)
    pulses = rng.uniform(-0.5, 0.5, (1000, 3)), np.cumsum(rng.uniform(-0.5, 0.5, (1000, 3)), axis=0)
    shifts = 0.5 * RECTIFICATION * np.outer(LEVELS**2, [1.0, 1.0, 4.0])
    return {"errors": (left, -left), "pulses": pulses, "shifts": shifts}


def honest_rings():
    """What rings without any mistake would give."""
    beats = model.beat(RATES * LOCK_IN, LOCK_IN) / LOCK_IN
    rng = np.random.default_rng(2)
    steps = Rings().sigma * np.sqrt(60.0) * rng.standard_normal((round(HOUR / 60.0), 3 * SEEDS))
    sound = np.tile(SHOWN, (round(END), 1))
    failing = sound.copy()
    failing[round(OFF) : round(ON)] = model.beat(SHOWN, 1.0)
    return {"shown": (beats, RATES), "walks": np.cumsum(steps, axis=0), "sound": sound, "failing": failing}


@pytest.mark.parametrize(
    ("module", "kind", "found"),
    [(increments, Increments, honest_increments()), (ring_laser, Rings, honest_rings())],
    ids=["increments", "ring lasers"],
)
def test_without_a_mistake_every_claim_holds_and_the_picture_is_drawn(module, kind, found):
    section = module.section(made(kind, **found))
    assert all(claim.holds for claim in section.claims)
    page = Page("")
    section.write(page)
    assert "data:image/png" in page.html()


@pytest.mark.parametrize(
    ("number", "change"),
    [
        (0, lambda f: {"errors": (f["errors"][0][[1, 1, 2, 3]], f["errors"][1])}),
        (0, lambda f: {"errors": (-f["errors"][0], f["errors"][1])}),
        (1, lambda f: {"errors": (f["errors"][0], -f["errors"][1])}),
        (2, lambda f: {"pulses": f["pulses"][::-1]}),
        (3, lambda f: {"shifts": 2.0 * f["shifts"]}),
        (3, lambda f: {"shifts": 0.0 * f["shifts"]}),
    ],
)
def test_a_mistake_of_increments_misses_its_claim(number, change):
    """Too many samples, what is found and what is right exchanged, twice, no remainder, the peak for the mean, none."""
    honest = honest_increments()
    claims = increments.section(made(Increments, **{**honest, **change(honest)})).claims
    assert [claim.holds for claim in claims] == [i != number for i in range(4)]
    assert claims[number].sentence == claims[number].opposite


@pytest.mark.parametrize(
    ("number", "change"),
    [
        (0, lambda f: {"shown": (RATES, RATES)}),
        (0, lambda f: {"shown": (np.sign(RATES) * np.maximum(np.abs(RATES) - 1.0, 0.0), RATES)}),
        (1, lambda f: {"walks": np.sqrt(2.0) * f["walks"]}),
        (1, lambda f: {"walks": 0.0 * f["walks"]}),
        (2, lambda f: {"failing": f["sound"]}),
        (2, lambda f: {"failing": np.where(np.arange(round(END))[:, None] < OFF, f["sound"], f["failing"][100])}),
    ],
)
def test_a_mistake_of_rings_misses_its_claim(number, change):
    """No lock-in, a dead band, twice the variance, no walk, a fault without effect, one that stays."""
    honest = honest_rings()
    claims = ring_laser.section(made(Rings, **{**honest, **change(honest)})).claims
    assert [claim.holds for claim in claims] == [i != number for i in range(3)]
    assert claims[number].sentence == claims[number].opposite
