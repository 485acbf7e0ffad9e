"""``navfmu analyse observability``: what distances along a track tell of which errors."""

from __future__ import annotations

import click


@click.command("observability")
@click.argument("file", type=click.Path())
@click.option("--track", type=click.Path(), required=True, help="A recorded track (CSV).")
@click.option("--stations", metavar="A,B", help="Those that are used; default: the two that cross best.")
@click.option("--model", default="reduced", show_default=True, help="Which errors: position, reduced, sensors or full.")
@click.option("--every", default="15", show_default=True, metavar="TIME", help="Between two distances.")
@click.option("--window", default="300", show_default=True, metavar="TIME", help="How long distances are collected.")
@click.option("--together", is_flag=True, help="Distances of all stations at a time, not in turn.")
@click.option("--wind", nargs=2, type=float, metavar="FROM KT", help="What the aircraft flew in, from degrees.")
@click.option("--distance-sigma", type=float, metavar="NMI", help="Noise of a distance; default: the model's.")
@click.option("--ground", default=0.0, metavar="FT", help="Height of the ground above the sea.  [default: 0]")
@click.option("--out", type=click.Path(dir_okay=False), help="A table of all windows to write, .csv.")
@click.option("--picture", type=click.Path(dir_okay=False), help="A picture to write, .png.")
def command(file, track, stations, model, every, window, together, wind, distance_sigma, ground, out, picture):
    """Show which errors of dead reckoning distances of stations of FILE tell along a track, and which they do not.

    Errors are in units of what is known of them beforehand, distances in their noise: a direction among the errors
    counts as observable where its singular value is 1 or more, where a window of distances tells as much of it as was
    known.

    \b
    navfmu analyse observability earth_nav.dat --track flight.csv --picture seen.png
    navfmu analyse observability earth_nav.dat --track flight.csv --model full --window '10 min' --together
    """
    import numpy as np

    from navfmu.analysis.error_state import MODELS
    from navfmu.analysis.observability import observability
    from navfmu.cli.place import along, chosen, elsewhere, within
    from navfmu.constants import FOOT, KNOT, NAUTICAL_MILE
    from navfmu.errors import NavfmuError, nearest
    from navfmu.files.numbers_as_text import text
    from navfmu.files.writing import write_file
    from navfmu.fmi.seconds import seconds
    from navfmu.navaids.file import read
    from navfmu.system.result import check_file

    if model not in MODELS:
        raise NavfmuError(f"--model is '{model}'; expected one of {', '.join(MODELS)}{nearest(model, MODELS)}")
    for target, option, kind in ((out, "--out", ".csv"), (picture, "--picture", ".png")):
        if target is not None:
            check_file(target, kind)
            elsewhere(target, option, file, track)
    every = within(seconds(every, "--every"), 0.1, 3600.0, "--every", "s")
    window = within(seconds(window, "--window"), 1.0, 86400.0, "--window", "s")
    sigma = None
    if distance_sigma is not None:
        sigma = within(distance_sigma, 1e-5, 10.0, "--distance-sigma", "nmi") * NAUTICAL_MILE
    wind_n = (0.0, 0.0)
    if wind:
        comes, speed = within(wind[0], 0.0, 360.0, "--wind", "deg"), within(wind[1], 0.0, 300.0, "--wind", "kt")
        wind_n = tuple(-speed * KNOT * float(of(np.radians(comes))) for of in (np.cos, np.sin))
    points = along(track, within(ground, -2000.0, 20000.0, "--ground", "ft") * FOOT)
    used = chosen(read(file), stations, points, file)
    found = observability(points, used, model, every=every, window=window, together=together, wind_n=wind_n,
                          sigma=sigma, source=track)  # fmt: skip
    _print(found)
    if out:
        write_file(out, text(found.columns()))
    if picture:
        from navfmu.analysis.observability_picture import draw

        write_file(picture, draw(found))
    if out or picture:
        click.echo(f"wrote {' and '.join(name for name in (out, picture) if name)}")


def _print(found) -> None:
    import numpy as np

    from navfmu.analysis.direction import apart, words
    from navfmu.analysis.error_state import MODELS
    from navfmu.analysis.observability import LEAST
    from navfmu.terminal.console import console, say
    from navfmu.terminal.table import Column, Table

    screen, weakest, count = console(), found.weakest, len(found.states)
    values = np.stack([one.values for one in found.windows])
    rows = [
        [f"{i + 1}", _number(np.median(of)), _number(weakest.values[i]), f"{100 * np.mean(of >= LEAST):.0f}"]
        for i, of in enumerate(values.T)
    ]
    headings = ("direction", "value, middle", "in the weakest window", "observable in windows, %")
    screen.print(Table([*map(Column, headings)], rows, f"{MODELS[found.model]}; {len(found.windows)} windows", keys=1))
    share = 100 * np.mean(found.ranks == count)
    say(screen, f"all {count} directions are observable in {share:.0f} % of the windows")
    where = f"weakest is the window from {weakest.start:g} to {weakest.end:g} s with {weakest.count} distances"
    if weakest.rank == count:
        least = words(weakest.directions[-1], found.states)
        say(screen, f"{where}; it tells least of {least}, to {weakest.left[-1]:.2g} of what was known")
    else:
        unseen = "; ".join(words(one, found.states) for one in apart(weakest.directions[weakest.rank :]))
        say(screen, f"{where}: it tells {weakest.rank} of {count} directions; not told, or hardly: {unseen}")


def _number(value: float) -> str:
    """Three digits; what is below 1e-6 is rounding."""
    return f"{value:.3g}" if value >= 1e-6 else "0"
