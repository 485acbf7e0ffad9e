"""The long runs that show what the project claims: ``python -m evidence`` writes them into one report.

Each module has a function ``run(out, page)`` that does its runs below the folder ``out`` (what is finished is kept and
not repeated) and adds its tables and pictures to the page.
"""
