"""The documentation site: Markdown pages as they lie here, and references that are made from the program itself."""

from __future__ import annotations

import sys
from pathlib import Path

from pygments.lexers import TextLexer
from sphinx.application import Sphinx

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE / "_ext"), str(HERE.parent / "src")]

from punchform import __version__  # noqa: E402

project = "punchform"
author = "The punchform authors"
copyright = author
version = release = __version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "plain_docstrings", "equations", "generated", "beside"]
exclude_patterns = ["_build", "_ext"]
source_suffix = {".md": "markdown"}
root_doc = "index"
nitpicky = True
# Types of other packages, and of ours that are not public, have no page to go to.
nitpick_ignore_regex = [(r"py:.*", r".*")]

myst_heading_anchors = 4
myst_enable_extensions = ["attrs_block", "colon_fence"]

# Indented blocks are formulas; commands and programs stand in fences that name their language.
highlight_language = "none"
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
python_display_short_literal_types = True
python_maximum_signature_line_length = 88

html_theme = "furo"
html_title = f"punchform {version}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
html_domain_indices = False
html_use_index = True
html_theme_options = {"navigation_with_keys": True}


def setup(app: Sphinx) -> None:
    """Tables of numbers have a language of their own for the tests, and no colours."""
    app.add_lexer("csv", TextLexer)
