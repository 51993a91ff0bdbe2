"""How Sphinx makes the site of these pages; `make docs` builds it into `build/site`."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tools"))

project = "faultpath"
author = copyright = "The faultpath authors"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "site_pages"]
# Files that reference runs are made of, each shown where a page speaks of its run.
exclude_patterns = ["reference/*/*", "reference/paper/*/*"]

# Anchors as the forge makes them.
myst_heading_anchors = 4

autodoc_default_options = {"member-order": "bysource", "exclude-members": "model_config"}
toc_object_entries_show_parents = "hide"
autodoc_typehints_format = "short"
python_use_unqualified_type_names = True
maximum_signature_line_length = 80

html_theme = "furo"
html_title = "faultpath"
html_static_path = ["site"]
html_css_files = ["site.css"]
html_use_index = html_domain_indices = False
html_show_sphinx = html_show_copyright = html_copy_source = False
# The reader's own fonts: the site fetches nothing.
html_theme_options = {"top_of_page_buttons": []}
