"""Extension of Sphinx for the site: notebooks, links to files that are no pages, our docstrings.

The pages are written for GitHub, which shows Markdown, and must read well there; whatever else the
site needs is done here.
"""

import json
import os
import re
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import nbformat
import yaml
from blocks import load
from docutils import nodes
from myst_parser.parsers.sphinx_ import MystParser
from nbclient import NotebookClient
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.util.osutil import relative_uri

from faultpath.api.folders import MAP
from faultpath.report.map import page as map_page

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"
REFERENCE = DOCS / "reference"
PAGES = ("report.html", "reproduction.html")
"""Pages of reference runs: the site shows them as they are."""


def executed(path: Path) -> nbformat.NotebookNode:
    """Return a notebook with the outputs that it has when it is run from top to bottom, in an
    empty folder that holds `examples`; raises `nbclient.exceptions.CellExecutionError`."""
    notebook: nbformat.NotebookNode = nbformat.read(path, as_version=4)
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "examples").symlink_to(ROOT / "examples")
        client = NotebookClient(
            notebook,
            timeout=300,
            resources={"metadata": {"path": folder}},
            extra_arguments=["--log-level=ERROR"],
        )
        client.log.setLevel("WARNING")
        client.execute()
    return notebook


def as_markdown(notebook: nbformat.NotebookNode) -> str:
    """Return a notebook's text, code and outputs as one MyST document, without the cells that are
    for a service which hosts notebooks."""
    parts: list[str] = []
    for cell in notebook.cells:
        if "hosted" in cell.metadata.get("tags", ()):
            continue
        if cell.cell_type == "markdown":
            parts.append(cell.source)
            continue
        parts.append(_fence("python", cell.source))
        shown = (output for output in cell.outputs if output.get("name") != "stderr")
        parts += [_output(output) for output in shown]
    return "\n\n".join(parts) + "\n"


def _output(output: Any) -> str:
    if output.output_type == "stream":
        return _fence("text", output.text.rstrip())
    if "text/html" in output.data:
        return _fence("{raw} html", f'<div class="output">{output.data["text/html"]}</div>')
    return _fence("text", output.data["text/plain"])


def _fence(info: str, body: str) -> str:
    return f"`````{info}\n{body}\n`````"


class NotebookParser(MystParser):
    """Runs a notebook, and reads it as a page."""

    supported = ("notebook",)

    def parse(self, inputstring: str, document: nodes.document) -> None:
        """Parse; `inputstring` is what Sphinx read of the file."""
        json.loads(inputstring)  # a damaged notebook is named before a kernel starts
        source = document.settings.env.doc2path(document.settings.env.docname)
        super().parse(as_markdown(executed(Path(source))), document)


_LISTS = yaml.safe_load(Path(__file__).with_name("side_bar.yaml").read_text("utf-8"))


def with_contents(app: Sphinx, name: str, source: list[str]) -> None:
    """Say which pages lie below a page; GitHub would show such a list as code."""
    del app
    lists = _LISTS["side_bar"] if name == "index" else {"": _LISTS["below"].get(name, ())}
    for caption, pages in lists.items():
        if pages:
            options = [":hidden:", *([f":caption: {caption}"] if caption else []), ":glob:", ""]
            source[0] += "\n".join(["", "```{toctree}", *options, *pages, "```", ""])


def linked(app: Sphinx, tree: nodes.document) -> None:
    """Let links to reports open them, links to run folders their report, and those to the README
    the start of the site. GitHub shows each where it lies."""
    here = app.env.docname
    folder = Path(app.env.doc2path(here)).parent
    for node in [*tree.findall(addnodes.download_reference), *tree.findall(addnodes.pending_xref)]:
        if node.get("reftype") != "myst":
            continue
        target = Path(os.path.normpath(folder / node["reftarget"]))
        if node.get("refdomain") == "doc":
            if node["reftarget"] == str(ROOT / "README"):
                node["reftarget"] = "index"
            if node["reftarget"] in app.env.found_docs:
                continue
            if (
                not Path(node["reftarget"]).is_relative_to(DOCS)
                and Path(f"{node['reftarget']}.md").is_file()
            ):  # the site has no page of it: finished studies, and what is for contributors
                node.replace_self(node.children)
                continue
            target = DOCS / Path(node["reftarget"]).parent
        page = next((target / name for name in PAGES if (target / name).is_file()), target)
        if (target / MAP).is_file():
            page = _map_page(target)
        if page.name in PAGES and page.is_relative_to(DOCS):
            uri = relative_uri(app.builder.get_target_uri(here), page.relative_to(DOCS).as_posix())
            node.replace_self(nodes.reference("", "", *node.children, refuri=uri, internal=True))


def with_files(app: Sphinx, error: Exception | None) -> None:
    """Put beside the site's own pages those of reference runs, those of maps made here, the films,
    which pages show by HTML, and the guide for assistants."""
    if error is None:
        site = Path(app.outdir)
        guide = (ROOT / "llms.txt").read_text("utf-8")
        (site / "llms.txt").write_text(_ON_SITE.sub(_of_site, guide), "utf-8")
        pages = (page for name in PAGES for page in REFERENCE.rglob(name))
        for file in (*pages, *(DOCS / "images").glob("film-*.svg")):
            target = site / file.relative_to(DOCS)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(file, target)
        for path in REFERENCE.glob(f"*/{MAP}"):
            run, target = load(path.parent.name), site / _map_page(path.parent).relative_to(DOCS)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(map_page(run.record, run.provenance), "utf-8")


_ON_SITE = re.compile(r"\((?:docs/([\w-]+)\.md|CHANGELOG\.md)\)")


def _of_site(link: re.Match[str]) -> str:
    """Link of the site to what a link of the repository leads to."""
    return f"({link[1] or 'release-notes'}.html)"


def _map_page(run: Path) -> Path:
    """Place beside a stored map at which the site has the page of it."""
    return run / "report.html"


CODE = re.compile(r"(?<!`)`([^`]+)`(?!`)")
MARKUP = re.compile(r"([*|])|(_)(?!\w)")


def plain(app: Sphinx, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Make reStructuredText of a docstring: it is plain text in which `code` has one backtick."""
    del app, name, thing, options
    lines[:] = "".join(_restructured("\n".join(lines))).split("\n")
    if what in ("attribute", "property"):
        lines.insert(0, "")  # else napoleon takes what stands before a colon for a type


PRIVATE = re.compile(r"[(\s]_\w+:")


def public(
    app: Sphinx, what: str, name: str, thing: Any, options: Any, taken: str | None, returned: Any
) -> tuple[str, Any] | None:
    """Show no call of a class that takes something private: only faultpath makes one."""
    del app, name, thing, options
    return ("", returned) if what == "class" and PRIVATE.search(taken or "") else None


def _restructured(text: str) -> Iterator[str]:
    for i, part in enumerate(CODE.split(text)):
        yield f"``{' '.join(part.split())}``" if i % 2 else MARKUP.sub(r"\\\g<0>", part)


def setup(app: Sphinx) -> dict[str, bool]:
    """Register all of it."""
    app.add_source_suffix(".ipynb", "notebook")
    app.add_source_parser(NotebookParser)
    app.connect("source-read", with_contents)
    app.connect("doctree-read", linked)
    app.connect("build-finished", with_files)
    app.connect("autodoc-process-docstring", plain, priority=400)  # before napoleon
    app.connect("autodoc-process-signature", public)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
