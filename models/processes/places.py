"""A few places for many candidates: who has one keeps it, and the best of the others get those that are free."""

from __future__ import annotations

import numpy as np


def filled(placed, wanted, merit, most):
    """Numbers of the candidates in each place after the free ones are given away, 0 where none is.

    Parameters
    ----------
    placed
        Number of the candidate in each place, from 1, or 0; shape (places,).
    wanted
        Candidates that may get a place, none of which has one; truth values of shape (candidates,).
    merit
        The least ones come first, and of equal ones the first; shape (candidates,).
    most
        Places beyond this many stay free.
    """
    number = np.arange(1, wanted.shape[0] + 1)
    before = (merit < merit[:, None]) | ((merit == merit[:, None]) & (number < number[:, None]))
    rank = np.sum(np.where(wanted & before, 1, 0), axis=1) + 1
    free = (placed == 0) & (np.arange(placed.shape[0]) < most)
    place = np.where(free, np.cumsum(np.where(free, 1, 0)), 0)
    taken = wanted & (place[:, None] == rank)
    return np.where(free, np.sum(np.where(taken, number, 0), axis=1), placed)


def has_one(placed, candidates):
    """Whether each of so many candidates has a place."""
    return np.any(placed[:, None] == np.arange(1, candidates + 1), axis=0)
