"""How Sphinx reads the assembled pages; `build.py` puts them together and calls it."""

import re
from pathlib import Path

from hybond._version import __version__

project = "hybond"
author = "The hybond developers"
copyright = "The hybond developers, Apache-2.0"
version = release = __version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
root_doc = "index"
source_suffix = {".md": "markdown"}

myst_heading_anchors = 4
myst_enable_extensions = ["attrs_inline"]

napoleon_google_docstring = False
napoleon_use_rtype = False
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the docstrings say what arguments are
default_role = "literal"  # docstrings put names between single backticks, which need no role

html_theme = "furo"
html_title = "hybond"
html_static_path = ["_static"]
html_css_files = ["hybond.css"]
html_copy_source = False
html_show_sphinx = False
highlight_language = "none"
pygments_style = "friendly"


def setup(app):
    """Give drawings their size: a link into a page then leads where it should while they load."""
    app.connect("html-page-context", sized)
    app.add_config_value("searched", True, "html", bool)
    app.connect("builder-inited", unsearched)


def unsearched(app):
    """Make no index of all words where nobody is to search."""
    app.builder.search = app.config.searched


def sized(app, pagename, templatename, context, doctree):
    """Write width and height of SVG files at their images in the text of a page."""
    if "body" not in context:
        return
    files = {Path(name).name: Path(app.srcdir) / file for file, name in app.builder.images.items()}

    def tag(found):
        file = files.get(found[1])
        if file is None or not file.is_file():
            return found[0]
        size = re.search(r'<svg[^>]* width="([\d.]+)" height="([\d.]+)"', file.read_text("utf-8"))
        if size is None:
            return found[0]
        width, height = (round(float(v)) for v in size.groups())
        return found[0].replace("<img ", f'<img width="{width}" height="{height}" ', 1)

    context["body"] = re.sub(r'<img [^>]*src="[^"]*?([^"/]+\.svg)"[^>]*>', tag, context["body"])
