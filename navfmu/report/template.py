"""Text from templates: files ending in ``.j2``, in a folder ``templates`` beside the module that fills them.

Whatever is filled in is escaped as in HTML; a name that a template uses and nobody gave is an error.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jinja2 import Environment


def fill(template: Path, **values: Any) -> str:
    """Return the text of a template with ``values`` in it; the same values give the same bytes."""
    return _environment(template.parent).get_template(template.name).render(values)


@cache
def _environment(folder: Path) -> Environment:
    import jinja2  # only where a page is written: it takes as long to import as the command line

    return jinja2.Environment(
        loader=jinja2.FileSystemLoader(folder),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
