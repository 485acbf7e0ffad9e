"""Samples of one table: columns of a file found, converted, turned into the player's axes, and put on its time."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np

from navfmu.errors import NavfmuError, nearest
from navfmu.files.numbers import label
from navfmu.recorded.replay.asked import Asked, amount, check_turn, scale, turn
from navfmu.recorded.replay.file import File
from navfmu.recorded.replay.wanted import Quantity, Wanted

ABSOLUTE = ("static_pressure", "temperature")
"""What is above 0, whatever it is: 0 or less stands for no number, where most are above."""
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


@dataclass(frozen=True)
class Source:
    """Where a quantity comes from, for the account."""

    columns: tuple[str, ...]  # of the file; none for a value that was given
    text: str


@dataclass
class Samples:
    """Samples in the player's units and axes, in order.

    ``time`` s, when one comes; ``time_of_validity`` s; ``valid``; ``number`` counts them from 1; ``row`` is that of the
    file; ``values`` name -> (samples,) or (samples, 3); ``known`` optional name -> where it was recorded.
    """

    wanted: Wanted
    time: np.ndarray
    time_of_validity: np.ndarray
    valid: np.ndarray
    number: np.ndarray
    row: np.ndarray
    values: dict[str, np.ndarray]
    known: dict[str, np.ndarray]
    sources: dict[str, Source]
    before: int = 0  # rows before t = 0
    repeats: int = 0  # samples that were left out because they repeat the one before
    incomplete: int = 0
    remarks: list[str] = field(default_factory=list)

    def __len__(self) -> int:
        return len(self.time)

    def only(self, keep: np.ndarray) -> Samples:
        """Return those of a mask, numbered anew."""
        parts = {name: getattr(self, name)[keep] for name in ("time", "time_of_validity", "valid", "row")}
        number = np.arange(1.0, np.count_nonzero(keep) + 1.0)
        values = {name: value[keep] for name, value in self.values.items()}
        known = {name: value[keep] for name, value in self.known.items()}
        return Samples(
            self.wanted,
            **parts,
            number=number,
            values=values,
            known=known,
            sources=self.sources,
            before=self.before,
            repeats=self.repeats,
            incomplete=self.incomplete,
            remarks=self.remarks,
        )

    def repeated(self) -> np.ndarray:
        """Return which samples repeat the values of the one before, to the last bit."""
        same = np.ones(len(self), bool)
        same[:1] = False
        for name, value in self.values.items():
            if self.sources[name].columns:
                same[1:] &= (value[1:] == value[:-1]).reshape(len(self) - 1, value[0].size).all(axis=1)
        return same

    def table(self) -> dict[str, np.ndarray]:
        """Return the player's table. Of samples with one time the last is in it: the others are lost in any tick."""
        last = np.append(np.diff(self.time) > 0.0, True)
        columns = {label("time", "s"): self.time, label("time_of_validity", "s"): self.time_of_validity}
        columns |= {label("sequence", "1"): self.number, label("valid", "1"): self.valid.astype(float)}
        for quantity in self.wanted.quantities:
            value = self.values.get(quantity.name, np.zeros((len(self), len(quantity.labels))))
            columns |= dict(zip(quantity.labels, value.reshape(len(self), -1).T, strict=True))
            if quantity.optional:
                known = self.known.get(quantity.name, np.zeros(len(self)))
                columns[label(f"{quantity.name}_known", "1")] = known.astype(float)
        rows = {name: columns[name][last] for name in self.wanted.labels}
        if np.count_nonzero(last) < 2:  # a table has two rows; a number that is no news is never published
            rows = {name: np.append(row, row) for name, row in rows.items()}
            rows[label("time", "s")][1] += 1.0
        return rows


def silence(wanted: Wanted) -> dict[str, np.ndarray]:
    """Return a table without samples."""
    rows = {name: np.zeros(2) for name in wanted.labels}
    rows[label("time", "s")][1] = 1.0
    return rows


def share(file: File, wanted: Wanted, asked: Asked) -> float:
    """Return how much a file has of what a table cannot do without, 0 to 1; 1 also where the user names some of it."""
    names = [quantity.name for quantity in wanted.quantities]
    if any(name in options for name in names for options in (asked.columns, asked.values)):
        return 1.0
    found = {quantity.name: bool(_columns(file, quantity, asked)) for quantity in wanted.quantities}
    needed = [(q.name,) for q in wanted.quantities if not q.optional] + wanted.one_of
    return sum(any(found[name] for name in group) for group in needed) / len(needed)


def take(file: File, wanted: Wanted, asked: Asked) -> Samples:
    """Return the samples that a file holds for a table."""
    found = {quantity.name: _columns(file, quantity, asked) for quantity in wanted.quantities}
    _check_found(file, wanted, asked, found)
    _check_shared(found)
    time, validity = _times(file, asked)
    values, sources = {}, {}
    for quantity in wanted.quantities:
        columns = found[quantity.name]
        if columns:
            values[quantity.name] = _converted(file, quantity, columns, asked)
            sources[quantity.name] = Source(columns, _told(file, quantity, columns, asked))
        elif quantity.name in asked.values:
            texts = asked.values[quantity.name]
            constant = _amounts(quantity, texts, f"--value {quantity.name}", difference=False)
            values[quantity.name] = np.tile(constant, (len(time), 1))[:, slice(None) if quantity.vector else 0]
            sources[quantity.name] = Source((), f"{quantity.name}: {', '.join(texts)}, given")
    valid = _valid(file, asked)
    samples = Samples(
        wanted,
        time,
        validity,
        valid,
        np.arange(1.0, len(time) + 1.0),
        np.arange(len(time)),
        values,
        {q.name: np.isfinite(values[q.name]) for q in wanted.quantities if q.optional and q.name in values},
        sources,
    )
    _complete(file, samples, asked)
    begun = samples.time >= 0.0
    samples.before = int(np.count_nonzero(~begun))
    if not begun.any():
        raise NavfmuError(
            f"{file.path}: the last time is {samples.time[-1] + _start(asked):g} s, and t = 0 is {_start(asked):g} s "
            "of the file: no sample is left; see --start"
        )
    samples = samples.only(begun)
    if asked.changes_only:
        repeated = samples.repeated()
        samples.repeats = int(np.count_nonzero(repeated))
        samples = samples.only(~repeated)
    return samples


def _start(asked: Asked) -> float:
    return asked.start or 0.0


def _columns(file: File, quantity: Quantity, asked: Asked) -> tuple[str, ...]:
    """Return the columns of a quantity: those that were named, or those with usual names, or none."""
    named = asked.columns.get(quantity.name)
    if named is None:
        usual = [] if quantity.name in asked.values else quantity.usual
        return next((columns for columns in usual if set(columns) <= set(file.names)), ())
    if len(named) != len(quantity.labels):
        raise NavfmuError(
            f"--column {quantity.name}: {len(named)} column(s) are named, {', '.join(named)}; expected "
            f"{len(quantity.labels)}, separated by commas"
        )
    columns = [column for column in named if column in file.names]
    if len(set(columns)) < len(columns):
        raise NavfmuError(f"--column {quantity.name}: {', '.join(named)}: a column is named twice")
    for column in named:
        if not (quantity.vector and _constant(file, column)):
            _check_column(file, column, f"--column {quantity.name}={','.join(named)}")
    return named


def _constant(file: File, column: str) -> bool:
    """Return whether a number stands in the place of a column."""
    return column not in file.names and _NUMBER.fullmatch(column) is not None


def _check_column(file: File, column: str, what: str) -> None:
    if column not in file.names:
        have = f"; its columns are {', '.join(file.names)}"
        raise NavfmuError(f"{file.path}: has no column '{column}' ({what}){nearest(column, file.names) or have}")


def _check_found(file: File, wanted: Wanted, asked: Asked, found: dict[str, tuple[str, ...]]) -> None:
    """Refuse a file that lacks what the player cannot do without."""

    def given(name: str) -> bool:
        return bool(found[name]) or name in asked.values

    free = [name for name in file.names if not any(name in columns for columns in found.values())]
    for quantity in wanted.quantities:
        if not quantity.optional and not given(quantity.name):
            usual = max(quantity.usual, key=lambda columns: len(set(columns) & set(free)))
            missing = [column for column in usual if column not in free]
            hint = next((near for name in missing if (near := nearest(name, set(free) - set(usual)))), ".")
            some = len(missing) < len(usual)
            told = ",".join("0" if column in missing else column for column in usual) if some else "..."
            raise NavfmuError(
                f"{file.path}: there is no column for {quantity.name}: {', '.join(missing)}{hint} Its columns are "
                f"{', '.join(file.names)}: name some with --column {quantity.name}={told}"
                + (" (a number stands for what was not recorded)" if some else f", or give --value {quantity.name}=...")
            )
    for group in wanted.one_of:
        if not any(map(given, group)):
            name, hint = next(((name, near) for name in group if (near := nearest(name, free))), (group[0], "."))
            raise NavfmuError(
                f"{file.path}: there is no column for {' or '.join(group)}, of which one is needed{hint} Its columns "
                f"are {', '.join(file.names)}: name one with --column {name}=..."
            )


def _check_shared(found: dict[str, tuple[str, ...]]) -> None:
    """Refuse a column for two quantities."""
    taken: dict[str, str] = {}
    for name, columns in found.items():
        for column in columns:
            if not _NUMBER.fullmatch(column) and taken.setdefault(column, name) != name:
                raise NavfmuError(f"--column {name}={','.join(columns)}: '{column}' is taken for {taken[column]}, too")


def _times(file: File, asked: Asked) -> tuple[np.ndarray, np.ndarray]:
    """Return when samples come and what time they hold for, s from --start on; it must not go back."""
    (column,) = asked.columns.get("time", ("time",))
    if column not in file.names and "time" not in asked.columns:
        raise NavfmuError(
            f"{file.path}: there is no column 'time'{nearest('time', file.names) or '.'} Its columns are "
            f"{', '.join(file.names)}: name it with --column time=..."
        )
    time = _time(file, "time", column, asked)
    back = np.diff(time) < 0.0
    if back.any():
        at = int(np.argmax(back)) + 1
        raise NavfmuError(
            f"{file.path}, {file.row(at)}: the time goes back, from {seconds(time[at - 1])} s to "
            f"{seconds(time[at])} s; expected rows in the order of time"
        )
    (column,) = asked.columns.get("time_of_validity", ("time_of_validity",))
    if column not in file.names and "time_of_validity" not in asked.columns:
        return time - _start(asked), time - _start(asked) - asked.age
    validity = _time(file, "time_of_validity", column, asked)
    late = validity > time
    if late.any() and not asked.unchecked:
        at = int(np.argmax(late))
        raise NavfmuError(
            f"{file.path}, {file.row(at)}: time_of_validity is {seconds(validity[at])} s, after the time at "
            f"which the sample comes, {seconds(time[at])} s"
        )
    return time - _start(asked), validity - _start(asked) - asked.age


def seconds(time: float) -> str:
    """A time with all the digits that tell samples apart, also in seconds of 1970."""
    return f"{time:.6f}".rstrip("0").rstrip(".") if abs(time) < 1e12 else f"{time:.6g}"


def _time(file: File, name: str, column: str, asked: Asked) -> np.ndarray:
    _check_column(file, column, f"--column {name}={column}")
    factor, offset = scale(_unit(file, name, (column,), "s", asked), "s", f"--unit {name}")
    time = file.numbers(column) * factor + offset if factor != 1.0 else file.numbers(column)
    if not np.isfinite(time).all():
        at = int(np.argmin(np.isfinite(time)))
        raise NavfmuError(f"{file.path}, {file.row(at)}: '{column}' is {time[at]:g}; expected a time")
    return time


def _valid(file: File, asked: Asked) -> np.ndarray:
    (column,) = asked.columns.get("valid", ("valid",))
    if column not in file.names and "valid" not in asked.columns:
        return np.ones(len(file.frame), bool)
    _check_column(file, column, f"--column valid={column}")
    numbers = file.numbers(column)
    return np.isfinite(numbers) & (numbers != 0.0)


def _unit(file: File, name: str, columns: tuple[str, ...], own: str, asked: Asked) -> str:
    """Return the unit that was told, else that of the header, else the player's own."""
    if name in asked.units:
        return asked.units[name]
    units = {file.units.get(column, own) for column in columns}
    if len(units) > 1:
        raise NavfmuError(f"{file.path}: the columns of {name} have the units {', '.join(sorted(units))}; expected one")
    return units.pop()


def _converted(file: File, quantity: Quantity, columns: tuple[str, ...], asked: Asked) -> np.ndarray:
    """Return a quantity in the player's unit and axes, (rows,) or (rows, 3)."""
    unit = _unit(file, quantity.name, columns, quantity.unit, asked)
    factor, offset = scale(unit, quantity.unit, f"{file.path}: {quantity.name}")
    rows = len(file.frame)
    parts = [np.full(rows, float(c)) if _constant(file, c) else file.numbers(c) for c in columns]
    value = np.stack(parts, axis=1)
    if (factor, offset) != (1.0, 0.0):
        value = value * factor + offset
    if quantity.name in ABSOLUTE and np.count_nonzero(value > 0.0) > 0.5 * rows:
        value = np.where(value > 0.0, value, np.nan)
    axes = _axes(quantity, asked)
    if axes:
        if quantity.frame == "b":
            check_turn(axes, f"--axes {','.join(axes)}: {quantity.name}")
        matrix = turn(axes, "--axes")
        value = value[:, np.argmax(np.abs(matrix), axis=1)] * matrix.sum(axis=1)
    if quantity.name in asked.add:
        value = value + _amounts(quantity, asked.add[quantity.name], f"--add {quantity.name}", difference=True)
    return value if quantity.vector else value[:, 0]


def _axes(quantity: Quantity, asked: Asked) -> tuple[str, ...] | None:
    """Return the axes that were told of a vector, or of all in its frame."""
    if not quantity.vector:
        return None
    return asked.axes.get(quantity.name, asked.axes.get("") if quantity.frame == "b" else None)


def _amounts(quantity: Quantity, texts: tuple[str, ...], what: str, *, difference: bool) -> np.ndarray:
    count = len(quantity.labels)
    if len(texts) not in (1, count):
        raise NavfmuError(f"{what}: {len(texts)} numbers are given; expected {count}, or one for all")
    numbers = [amount(text, quantity.unit, what, difference=difference) for text in texts]
    return np.broadcast_to(np.array(numbers), count)


def _told(file: File, quantity: Quantity, columns: tuple[str, ...], asked: Asked) -> str:
    text = f"{quantity.name}: {', '.join(columns)} ({_unit(file, quantity.name, columns, quantity.unit, asked)})"
    if axes := _axes(quantity, asked):
        text += f", axes {', '.join(axes)}"
    if quantity.name in asked.add:
        text += f", plus {', '.join(asked.add[quantity.name])}"
    return text


def _complete(file: File, samples: Samples, asked: Asked) -> None:
    """Refuse rows that lack a number, or make them samples that are not valid and have the last values."""
    whole = samples.valid.copy()
    missing = np.zeros(len(samples), bool)
    which = np.full(len(samples), "", object)
    needed = [(q.name,) for q in samples.wanted.quantities if not q.optional] + samples.wanted.one_of
    for group in needed:
        there = [
            np.isfinite(samples.values[n]).reshape(len(samples), -1).all(axis=1) for n in group if n in samples.values
        ]
        lacks = ~np.any(there, axis=0)
        which[lacks & ~missing] = " or ".join(group)
        missing |= lacks
    at_fault = missing & whole
    if at_fault.any() and asked.incomplete == "refuse":
        at = int(np.argmax(at_fault))
        raise NavfmuError(
            f"{file.path}, {file.row(at)}: {which[at]} is empty or no number (in {int(at_fault.sum())} row(s) "
            "something is); with --incomplete invalid such a row is a sample that is not valid and has the values of "
            "the last one"
        )
    samples.incomplete = int(at_fault.sum())
    samples.valid = whole & ~missing
    if not samples.valid.any():
        raise NavfmuError(f"{file.path}: no row is complete and valid; expected samples")
    last = np.maximum.accumulate(np.where(samples.valid, np.arange(len(samples)), -1))
    last[last < 0] = int(np.argmax(samples.valid))  # before the first one, the first
    samples.values = {name: value[last] for name, value in samples.values.items()}
    samples.known = {name: value[last] for name, value in samples.known.items()}
    for name, known in samples.known.items():
        samples.values[name] = np.where(known, samples.values[name], 0.0)
