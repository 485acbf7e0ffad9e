"""Templates: what is filled in is escaped, what is missing is an error, and nobody else pays for the engine."""

import subprocess
import sys

import jinja2
import pytest

from navfmu.report.template import fill


def test_what_is_filled_in_is_text_and_what_is_missing_is_an_error(tmp_path):
    template = tmp_path / "small.html.j2"
    template.write_text("<p>{{ words }}</p>\n")
    assert fill(template, words="a < b & <script>") == "<p>a &lt; b &amp; &lt;script&gt;</p>\n"
    with pytest.raises(jinja2.UndefinedError, match="words"):
        fill(template, wrods="a")


@pytest.mark.parametrize("module", ["navfmu.report.page", "navfmu.export", "navfmu.export.build", "navfmu.cli.main"])
def test_the_engine_is_loaded_where_a_page_is_written_only(module):
    code = f"import {module}, sys; sys.exit('jinja2' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0
