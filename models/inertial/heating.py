"""Temperature inside a sensor's package: it warms itself after turn-on, and follows its surroundings as slowly.

One thermal mass, tau dT/dt = T_around + rise - T, as warm as its surroundings when it is turned on. Where they stay as
they are, T - T_around = rise (1 - exp(-t / tau)): the transient of thesis Fig 3.5, "most probably the result of
temperature changes caused by self-heating after gyro turn-on", which "lasts for about 3 hours". The same mass "shields
the sensing elements from outside temperature changes" (p. 47): 15 minutes of another temperature are hardly seen.
"""

from __future__ import annotations


def advance(temperature, around, rise, decay):
    """Temperature one period later, K; ``decay`` = exp(-period / tau)."""
    return decay * temperature + (1.0 - decay) * (around + rise)
