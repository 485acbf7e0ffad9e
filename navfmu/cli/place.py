"""What commands that look at stations share: a place, heights and a track as they are told."""

from __future__ import annotations

import math


def place(near, option="--near"):
    """Latitude and longitude in rad of an option, checked."""
    from navfmu.errors import NavfmuError

    latitude, longitude = near
    if not -89.0 <= latitude <= 89.0 or not -180.0 <= longitude <= 180.0:
        raise NavfmuError(
            f"{option} is {latitude:g} {longitude:g}; expected degrees, latitude of -89 to 89, longitude of -180 to 180"
        )
    return math.radians(latitude), math.radians(longitude)


def within(value, least, largest, option, unit):
    """A number of an option, or a sentence what it may be."""
    from navfmu.errors import NavfmuError

    if not least <= value <= largest:
        raise NavfmuError(f"{option} is {value:g} {unit}; expected {least:g} to {largest:g}")
    return value


def unused(track, belongs, **options):
    """A sentence where options are given that a track leaves unused; ``belongs`` says to what they belong."""
    from navfmu.errors import NavfmuError

    for name, value in options.items():
        if track is not None and value is not None:
            raise NavfmuError(f"--{name} belongs to {belongs}; a track has places and heights of its own")


def elsewhere(target, option, *sources):
    """A sentence where a file that is read would be written over."""
    from navfmu.errors import NavfmuError
    from navfmu.files.reading import located

    if target is not None and any(located(target) == located(source) for source in sources if source is not None):
        raise NavfmuError(f"{option} {target} is a file that is read; expected another name")


def along(track, ground):
    """The points of a recorded track."""
    from navfmu.navaids.coverage import Points
    from navfmu.recorded.track import read

    flown = read(track)
    return Points(flown.latitude, flown.longitude, flown.altitude, ground, time=flown.time)


def reachable(stations, points):
    """Those of the stations that are near enough to a point to be heard anywhere, by the longest range of all."""
    import numpy as np

    from navfmu.navaids.station import distance

    middle = len(points.latitude) // 2
    here = float(points.latitude[middle]), float(points.longitude[middle])
    spread = float(np.max(distance(*here, points.latitude, points.longitude)))
    longest = max(one.range for one in stations.stations)
    return stations.within(*here, spread + 1.001 * longest)  # places below the sea are nearer than on it


def chosen(found, named, points, file):
    """The stations that are named, or the two that cross best; a sentence where there is none."""
    from navfmu.errors import NavfmuError, nearest
    from navfmu.navaids.choice import choose

    if named is None:
        best = choose(reachable(found, points), points, 2)
        if not best:
            raise NavfmuError(f"{file}: none of its {len(found.stations)} stations is heard there")
        return best
    near = found.within(float(points.latitude[0]), float(points.longitude[0]), 1e9)
    first = {}
    for one in near:
        first.setdefault(one.ident, one)  # names are used again far away
    idents = [ident.strip() for ident in named.split(",")]
    for ident in idents:
        if ident not in first:
            raise NavfmuError(f"--stations: {file} has no station '{ident}'{nearest(ident, first)}")
    if len(set(idents)) < len(idents):
        raise NavfmuError(f"--stations is {named}; expected each station once")
    return [first[ident] for ident in idents]
