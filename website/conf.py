"""How Sphinx reads the assembled pages; `build.py` puts them together and calls it."""

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
