"""How Sphinx builds the documentation: `make docs`. Nothing is fetched, and every warning fails."""

import sys
import tomllib
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE / "extensions"), str(HERE.parents[1])]

project = "Bohemia"
author = copyright = "The Bohemia authors"
version = release = tomllib.loads((HERE.parents[1] / "pyproject.toml").read_text("utf-8"))[
    "project"
]["version"]

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.autosectionlabel",
    "formats",
    "formulas",
    "machines",
    "commands",
    "docstrings",
    "links",
]
exclude_patterns = ["extensions", "notebooks"]
suppress_warnings = ["autosectionlabel.*"]  # headings that come twice are not referred to
autosectionlabel_prefix_document = True
myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_heading_anchors = 3
highlight_language = "text"

# What stands in single backticks in docstrings is code.
default_role = "code"
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True
napoleon_custom_sections = [("Example", "Example")]

html_theme = "furo"
html_title = "Bohemia"
html_math_renderer = "mathml"
html_static_path = ["static"]
html_css_files = ["bohemia.css"]
html_copy_source = False
html_show_sphinx = False
