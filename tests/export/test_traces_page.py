"""The page of what traces says what the tests try."""

from .traces_page import PAGE, page


def test_the_page_is_that_of_the_tests():
    """Else: python -m tests.export.traces_page."""
    assert PAGE.read_text(encoding="utf-8") == page()
