"""The long runs that show what the project claims: ``python -m evidence`` writes them into one report.

Each module has a function ``run(out)`` that does its runs below the folder ``out`` (what is finished is kept and not
repeated) and returns a ``Section``: claims with what was measured, and a function that adds tables and pictures to a
page. A claim that is missed makes the exit code 1; titles and sentences say what was found.
"""
