"""``navfmu analyse fix``: how well distances and bearings of stations fix a position."""

from __future__ import annotations

import click


@click.command("fix")
@click.argument("file", type=click.Path())
@click.option("--near", nargs=2, type=float, metavar="LAT LON", help="A place, in degrees.")
@click.option("--altitude", type=float, metavar="FT", help="Of the place, above the sea.  [default: 5000]")
@click.option("--radius", type=float, metavar="NMI", help="A map around the place, so far to each side.")
@click.option("--track", type=click.Path(), help="A recorded track (CSV) in place of a place.")
@click.option("--stations", metavar="A,B", help="Those that are used; default: the two that cross best.")
@click.option("--distance-sigma", default=0.17, show_default=True, metavar="NMI", help="Error of a distance.")
@click.option("--bearing-sigma", default=1.0, show_default=True, metavar="DEG", help="Error of a bearing.")
@click.option("--draws", type=int, metavar="N", help="Fixes with errors, at a place.  [default: 20000]")
@click.option("--seed", default=1, show_default=True, metavar="N", help="Of the errors that are drawn.")
@click.option("--ground", default=0.0, metavar="FT", help="Height of the ground above the sea.  [default: 0]")
@click.option("--out", type=click.Path(dir_okay=False), help="A table of all points to write, .csv.")
@click.option("--picture", type=click.Path(dir_okay=False), help="A picture to write, .png.")
def command(file, near, altitude, radius, track, stations, distance_sigma, bearing_sigma, draws, seed, ground, out,
            picture):  # fmt: skip
    """Show the error ellipses of rho-rho, rho-theta and theta-theta fixes from stations of FILE.

    FILE is what 'navfmu stations' reads. Heights are known, the Earth is the ellipsoid. At a place the fix is also
    done with errors that are drawn, and its other solution is told.

    \b
    navfmu analyse fix earth_nav.dat --near 37.69 -121.82 --picture fix.png
    navfmu analyse fix earth_nav.dat --near 37.69 -121.82 --stations OAK,SJC --radius 30 --picture map.png
    navfmu analyse fix earth_nav.dat --track flight.csv --out fix.csv
    """
    import math

    from navfmu.analysis.fix import Fixes, methods
    from navfmu.analysis.place import Place
    from navfmu.cli.place import along, chosen, elsewhere, place, unused, within
    from navfmu.constants import FOOT, NAUTICAL_MILE
    from navfmu.errors import NavfmuError
    from navfmu.files.numbers_as_text import text
    from navfmu.files.writing import write_file
    from navfmu.navaids.coverage import Points
    from navfmu.navaids.file import read
    from navfmu.system.result import check_file

    if (not near) == (track is None):
        raise NavfmuError("expected either --near LAT LON for a place or --track FILE")
    unused(track, "a place", radius=radius, altitude=altitude, draws=draws)
    if radius is not None and draws is not None:
        raise NavfmuError("--draws belongs to a place; a map has none")
    for target, option, kind in ((out, "--out", ".csv"), (picture, "--picture", ".png")):
        if target is not None:
            check_file(target, kind)
            elsewhere(target, option, file, track)
    ground = within(ground, -2000.0, 20000.0, "--ground", "ft") * FOOT
    far = within(distance_sigma, 1e-4, 10.0, "--distance-sigma", "nmi") * NAUTICAL_MILE
    turn = math.radians(within(bearing_sigma, 1e-3, 30.0, "--bearing-sigma", "deg"))
    draws = within(20000 if draws is None else draws, 1000, 1000000, "--draws", "fixes")
    here = None
    if near:
        altitude = within(5000.0 if altitude is None else altitude, -2000.0, 100000.0, "--altitude", "ft") * FOOT
        if altitude < ground:
            raise NavfmuError(f"--altitude is {altitude / FOOT:g} ft, below the ground at {ground / FOOT:g} ft")
        here = Place(*place(near), altitude)
        points = here.points(ground)
        if radius is not None:
            radius = within(radius, 0.1, 500.0, "--radius", "nmi") * NAUTICAL_MILE
            points = Points.around(here.latitude, here.longitude, radius, 81, [altitude - ground], ground)
    else:
        points = along(track, ground)
    used = chosen(read(file), stations, here.points(ground) if here else points, file)
    fixes = Fixes.of(methods(used, far, turn), points)
    drawing = _at_place(fixes, here, draws, seed) if near and radius is None else _over_points(fixes)
    name = " and ".join(one.ident for one in used)
    if out:
        write_file(out, text(fixes.columns()))
    if picture:
        write_file(picture, drawing(name))
    if out or picture:
        click.echo(f"wrote {' and '.join(target for target in (out, picture) if target)}")


def _at_place(fixes, here, count, seed):
    """Print what each fix gives at a place; return what draws it."""
    import numpy as np

    from navfmu.analysis.circle import principal, radius
    from navfmu.analysis.fix import crossing, direction, drawn, useless
    from navfmu.analysis.ghost import ghost
    from navfmu.constants import NAUTICAL_MILE
    from navfmu.errors import NavfmuError
    from navfmu.terminal.console import console, say
    from navfmu.terminal.table import Column, Kind, Table

    rows, sentences, draws = [], [], {}
    for name, packed in fixes.covariance.items():
        lines, one = fixes.lines[name], packed[0]
        angle = f"{np.degrees(crossing(lines, here)):.1f}"
        if not np.all(np.isfinite(one)):
            rows.append([name, angle, *["-"] * 7])
            sentences.append(f"{name}: {useless(lines, fixes.points, here)}")
            continue
        long, short = principal(one)
        draws[name] = drawn(lines, here, count, seed)
        lengths = np.hypot(*draws[name].T)
        claimed = float(radius(one, 0.95))
        observed = float(np.quantile(np.where(np.isfinite(lengths), lengths, np.inf), 0.95, method="higher"))
        numbers = long, short, np.sqrt(one[0] + one[2]), radius(one, 0.5), claimed
        rows.append(
            [name, angle, f"{round(float(np.degrees(direction(one)))) % 180}", *(f"{number:.0f}" for number in numbers)]
        )
        rows[-1].append(f"{observed:.0f}" if np.isfinite(observed) else "-")
        none = 1.0 - float(np.mean(np.isfinite(lengths)))
        inside, bound = _inside(draws[name], one)
        if abs(inside - 0.95) > bound:
            sentences.append(
                f"{name}: its ellipse of 95 % holds {100 * inside:.1f} % of {count} fixes with errors, and by chance "
                f"it would be {100 * bound:.1f} % off at most: so far its lines are not straight"
                + (f"; {100 * none:.1f} % of the fixes have no solution" if none else "")
            )
        other = ghost(lines, here)
        if other is not None:
            offset = here.offset(other.latitude, other.longitude)
            sentences.append(
                f"{name}: the circles cross a second time {np.hypot(*offset) / NAUTICAL_MILE:.2f} nmi away, at "
                f"{np.degrees(other.latitude):.4f} {np.degrees(other.longitude):.4f}; a bearing, a third distance or "
                "what is known of the place must tell them apart"
            )
    if not draws:
        raise NavfmuError(f"there is no fix at this place: {'; '.join(sentences)}")
    headings = ("cross at, deg", "long axis to, deg", "long axis, m", "short axis, m", "drms, m", "50 % circle, m",
                "95 % circle, m", f"of {count} fixes, m")  # fmt: skip
    screen = console()
    screen.print(Table([Column("fix", Kind.WORD), *map(Column, headings)], rows, "error ellipses of one sigma", keys=1))
    for sentence in sentences:
        say(screen, sentence)

    def drawing(name):
        from navfmu.analysis.fix_picture import at_place

        return at_place(here, fixes, draws)

    return drawing


def _inside(errors, packed):
    """Share of errors within the ellipse of 95 %, and what chance moves it by, three sigma of the binomial."""
    import numpy as np

    north, both, east = packed
    x, y = errors.T
    square = (east * x * x - 2.0 * both * x * y + north * y * y) / (north * east - both * both)
    return float(np.mean(square <= -2.0 * np.log(0.05))), 3.0 * float(np.sqrt(0.95 * 0.05 / len(errors)))


def _over_points(fixes):
    """Print how good each fix is over many points; return what draws it."""
    import numpy as np

    from navfmu.analysis.circle import principal, radius
    from navfmu.constants import NAUTICAL_MILE
    from navfmu.errors import NavfmuError
    from navfmu.terminal.console import console
    from navfmu.terminal.table import Column, Kind, Table

    rows = []
    for name, packed in fixes.covariance.items():
        known = np.isfinite(packed).all(axis=-1)
        if not known.any():
            rows.append([name, "0.0", *["-"] * 4])
            continue
        long, circle = (values / NAUTICAL_MILE for values in (principal(packed[known])[0], radius(packed[known], 0.95)))
        numbers = (np.quantile(of, q) for of in (long, circle) for q in (0.5, 0.95))
        rows.append([name, f"{100 * np.mean(known):.1f}", *(f"{number:.2f}" for number in numbers)])
    if all(row[1] == "0.0" for row in rows):
        raise NavfmuError(
            "there is no fix at any point: the stations are not heard together, or their lines never cross"
        )
    headings = ("points, %", "long axis, nmi", "of 95 % of them", "95 % circle, nmi", "of 95 % of them")
    console().print(
        Table([Column("fix", Kind.WORD), *map(Column, headings)], rows, "fixes, middle of the points", keys=1)
    )

    def drawing(name):
        from navfmu.analysis.fix_picture import along, on_map

        return (on_map if fixes.points.shape else along)(fixes, name)

    return drawing
