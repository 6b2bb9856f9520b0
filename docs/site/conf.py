"""Sphinx's configuration. The pages that it reads are staged by build.py, see there."""
import os

project = "pbf"
author = "the pbf authors"
project_copyright = ""
extensions = ["myst_parser", "breathe"]
root_doc = "index"
html_theme = "furo"
html_title = "pbf"
html_show_copyright = False
html_show_sourcelink = False
html_copy_source = False
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_theme_options = {"top_of_page_buttons": []}
pygments_style = "friendly"
pygments_dark_style = "native"

myst_heading_anchors = 5
myst_enable_extensions = ["deflist"]

breathe_projects = {"pbf": os.environ["PBF_DOCS_XML"]}
breathe_default_project = "pbf"
breathe_domain_by_extension = {"h": "c"}
breathe_show_define_initializer = True
breathe_show_enumvalue_initializer = True

# Types that C or others declare, and parameters of callbacks.
nitpick_ignore_regex = [("c:identifier", r"u?int(8|16|32|64)_t|double|char|size_t|DLManagedTensor")]
