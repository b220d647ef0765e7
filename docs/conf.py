"""How the site is built: Sphinx with Markdown pages; nothing in a page comes from another host."""

from __future__ import annotations

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_ext"))

import pictures  # noqa: E402
import stillrate  # noqa: E402

project = "stillrate"
author = "The stillrate developers"
release = version = stillrate.__version__
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "pages",
    "mathml",
    "settings",
    "scores",
    "elementary",
    "shapes",
]

source_suffix = {".md": "markdown"}
exclude_patterns = ["generated/doctrees", "generated/extra"]
myst_enable_extensions = [
    "dollarmath",
    "colon_fence",
    "deflist",
    "attrs_block",
    "attrs_inline",
]
myst_heading_anchors = 3

html_theme = "furo"
html_title = "stillrate"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_extra_path = ["generated/extra"]
html_math_renderer = "mathml"
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
# The summaries would be fetched, which a page opened from a disk may not.
html_show_search_summary = False
html_show_copyright = False
html_theme_options = {"navigation_with_keys": True, "footer_icons": []}
pygments_style = "tango"
pygments_dark_style = "monokai"

default_role = "literal"
napoleon_google_docstring = False
napoleon_use_rtype = False
autodoc_typehints = "none"
autodoc_member_order = "bysource"
autodoc_class_signature = "mixed"

(HERE / "generated" / "extra").mkdir(parents=True, exist_ok=True)
pictures.draw_all(HERE / "generated" / "methods")
