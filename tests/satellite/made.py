"""Files of satellite navigation, written as their formats say; two ephemerides are published ones with results."""

from __future__ import annotations

import gzip
from pathlib import Path

REMONDI = """\
20 01  7 23  2  0  0.0 -.857324339449D-04 -.272848410532D-11  .000000000000D+00
     .200000000000D+02  .886875000000D+02  .465376527657D-08  .105827953357D+01
     .457651913166D-05  .223578442819D-02  .177137553692D-05  .515379589081D+04
     .936000000000D+05  .651925802231D-07  .164046615454D+01 -.856816768646D-07
     .961685061380D+00  .344968750000D+03  .206374037770D+01 -.856928551657D-08
     .342514267094D-09  .000000000000D+00  .112400000000D+04  .000000000000D+00
     .200000000000D+01  .000000000000D+00 -.651925802231D-08  .276000000000D+03
     .865800000000D+05  .000000000000D+00  .000000000000D+00  .000000000000D+00
"""
"""Sample message of B. W. Remondi, Computing satellite velocity using the broadcast ephemeris, GPS Solutions 8 (2004),
whose program bc_velo.c prints position and velocity at 86400 s."""
GLAB = """\
20 16  3  1  0  0  0.0 0.396233052015D-03 0.261479726760D-11 0.000000000000D+00
    0.100000000000D+02-0.231562500000D+02 0.530236372187D-08 0.253477496869D+00
   -0.111199915409D-05 0.483385741245D-02 0.810064375401D-05 0.515369705963D+04
    0.172800000000D+06-0.141561031342D-06 0.304306271006D+00 0.372529029846D-08
    0.926615731710D+00 0.207250000000D+03 0.133849764271D+01-0.843427989304D-08
   -0.164292557730D-09 0.100000000000D+01 0.188600000000D+04 0.000000000000D+00
    0.200000000000D+01 0.000000000000D+00-0.838190317154D-08 0.100000000000D+02
    0.172770000000D+06 0.400000000000D+01 0.000000000000D+00 0.000000000000D+00
"""
"""Broadcast by satellite 20 on 2016-03-01; the program gLAB of ESA and UPC has its state at 172799.92312317 s."""


def line(text: str, label: str) -> str:
    """A line of a RINEX header."""
    return f"{text:60}{label}\n"


def navigation_2(*messages: str) -> str:
    """A navigation file of version 2."""
    return (
        line("     2.10           N: GPS NAV DATA", "RINEX VERSION / TYPE")
        + line("made", "PGM / RUN BY / DATE")
        + line("    0.1118D-07 -0.7451D-08 -0.5960D-07  0.1192D-06", "ION ALPHA")
        + line("    0.1167D+06 -0.2294D+06 -0.1311D+06  0.1049D+07", "ION BETA")
        + line("", "END OF HEADER")
        + "".join(messages)
    )


def navigation_3(*messages: str, system: str = "M: MIXED") -> str:
    """A navigation file of version 3, of messages of version 2 or 3."""
    return (
        line(f"     3.04           N: GNSS NAV DATA    {system}", "RINEX VERSION / TYPE")
        + line("GPSA   1.1180e-08 -7.4510e-09 -5.9600e-08  1.1920e-07", "IONOSPHERIC CORR")
        + line("GPSB   1.1670e+05 -2.2940e+05 -1.3110e+05  1.0490e+06", "IONOSPHERIC CORR")
        + line("", "END OF HEADER")
        + "".join(_of_version_3(m) if m[0] in " 0123456789" else m for m in messages)
    )


def navigation_4(*messages: str, ionosphere: str = "> ION G20 LNAV") -> str:
    """A navigation file of version 4, of messages of version 2 or 4; coefficients are those of the others."""
    return (
        line("     4.00           N: GNSS NAV DATA    M: MIXED", "RINEX VERSION / TYPE")
        + line("", "END OF HEADER")
        + ionosphere
        + "\n    2016 03 01 00 00 00 1.118000000000e-08-7.451000000000e-09-5.960000000000e-08\n"
        + "     1.192000000000e-07 1.167000000000e+05-2.294000000000e+05-1.311000000000e+05\n"
        + "     1.049000000000e+06\n"
        + "".join(f"> EPH G{m[:2]} LNAV\n{_of_version_3(m)}" if m[0] in " 0123456789" else m for m in messages)
    )


CNAV = f"> EPH G05 CNAV\n{GLAB}"
"""A message of another kind, which has more lines and other numbers."""


def _of_version_3(message: str) -> str:
    first, *rest = message.splitlines(keepends=True)
    prn, year, month, day, hour, minute = (int(first[k : k + 2]) for k in (0, 3, 6, 9, 12, 15))
    return f"G{prn:02d} 20{year:02d} {month:02d} {day:02d} {hour:02d} {minute:02d} 00{first[22:]}" + "".join(
        " " + line_ for line_ in rest
    )


GLONASS = """\
R01 2016 03 01 00 15 00 1.234000000000e-04 0.000000000000e+00 1.728000000000e+05
     1.000000000000e+04 1.000000000000e+00 0.000000000000e+00 0.000000000000e+00
     1.000000000000e+04 1.000000000000e+00 0.000000000000e+00 1.000000000000e+00
     1.000000000000e+04 1.000000000000e+00 0.000000000000e+00 0.000000000000e+00
"""

YUMA = """\
******** Week  {week} almanac for PRN-{prn:02d} ********
ID:                         {prn:02d}
Health:                     000
Eccentricity:               0.1000000000E-001
Time of Applicability(s):  319488.0000
Orbital Inclination(rad):   0.9600000000
Rate of Right Ascen(r/s):  -0.7508884204E-008
SQRT(A)  (m 1/2):           5153.600000
Right Ascen at Week(rad):  -0.5000000000E+000
Argument of Perigee(rad):  -1.700000000
Mean Anom(rad):             0.4000000000E+000
Af0(s):                     0.1000000000E-003
Af1(s/s):                   0.3600000000E-011
week:                        {week}

"""


def yuma(*prns: int, week: int = 377) -> str:
    """A YUMA almanac, all satellites in one place."""
    return "".join(YUMA.format(prn=prn, week=week) for prn in prns)


SEM_ENTRY = """\
{prn}
{svn}
0
 0.10000000000000E-0001  5.57749073643905E-0003 -2.39015213999026E-0009
 0.51536000000000E+0004 -1.59154943091895E-0001 -5.41126806512444E-0001
 1.27323954473516E-0001  0.10000000000000E-0003  0.36000000000000E-0011
0
9

"""
"""The same satellite: the angles divided by pi, the inclination less 0.3."""


def sem(*prns: int, week: int = 377) -> str:
    """A SEM almanac of the same satellites as :func:`yuma`."""
    head = f"{len(prns)}  CURRENT.ALM\n {week} 319488\n\n"
    return head + "".join(SEM_ENTRY.format(prn=prn, svn=prn + 20) for prn in prns)


OBSERVED_3 = (
    line("     3.05           OBSERVATION DATA    M: MIXED", "RINEX VERSION / TYPE")
    + line("MADE", "MARKER NAME")
    + line("  3582105.2910   532589.7313  5232754.8054", "APPROX POSITION XYZ")
    + line("G    4 C1C L1C D1C S1C", "SYS / # / OBS TYPES")
    + line("R    2 C1C L1C", "SYS / # / OBS TYPES")
    + line("  2020     6    25     0     0    0.0000000     GPS", "TIME OF FIRST OBS")
    + line("", "END OF HEADER")
    + """\
> 2020 06 25 00 00 00.0000000  0  3
G02  25847357.745 3                     -3123.088 3        22.000
G05  20947300.931 8 110078836.38908         0.000          50.500
R07  21777182.297 8 114439911.63508
> 2020 06 25 00 00 30.0000000  4  1
SOMETHING HAPPENED                                          COMMENT
> 2020 06 25 00 01 00.0000000  0  1
G05  20959368.361 8 110142251.48508     -1077.284 8        49.500
"""
)
OBSERVED_2 = (
    line("     2.11           OBSERVATION DATA    M (MIXED)", "RINEX VERSION / TYPE")
    + line("MADE", "MARKER NAME")
    + line("     6    C1    L1    P2    D1    S1    S2", "# / TYPES OF OBSERV")
    + line("  2005     3    24    13    10   36.0000000     GPS", "TIME OF FIRST OBS")
    + line("", "END OF HEADER")
    + """\
 05  3 24 13 10 36.0000000  0 13G12G09G06R21R22G01G02G03G04G05G07G08 -.123456789
                                G10
"""
    + "".join(
        f"{20000000.0 + prn:14.3f}  {1e8 + prn:14.3f}  {'':16}{-100.0 - prn:14.3f}  {40.0 + prn / 10:14.3f}  \n"
        f"{30.0:14.3f}\n"
        for prn in (12, 9, 6, 21, 22, 1, 2, 3, 4, 5, 7, 8, 10)
    )
    + """\
                            4  1
 *** ANTENNA IS NOW ON THE ROOF                             COMMENT
 05  3 24 13 11  6.0000000  0  1 12
  20000112.000
        31.000
"""
)


def written(folder: Path, name: str, text: str) -> Path:
    """A file of this text, packed by gzip where the name ends so."""
    path = folder / name
    data = text.encode("latin1")
    path.write_bytes(gzip.compress(data) if name.endswith(".gz") else data)
    return path
