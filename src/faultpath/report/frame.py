"""Frame of every page: one file that loads nothing and runs nothing but our own scripts.

The page states its own content-security policy. Styles and scripts are allowed by their digests,
so that markup that a name might smuggle past the escapes neither runs nor loads anything: no other
script, no handler in an attribute, no style attribute, no picture, frame, form or connection.
"""

import hashlib
import os
import re
from base64 import b64encode
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from faultpath.core import __version__
from faultpath.core.files.atomic import check_mark, holds_others, is_run, make_folder, write_text
from faultpath.core.text import counted
from faultpath.report.escapes import unbroken, visible
from faultpath.report.sentences import wording

PAGE = b'<meta name="generator" content="faultpath '
"""Text in the head of every page."""
STYLES = ("tokens.css", "svg.css", "page.css")
_SHORT = 24
"""Letters of a name that still fit into a line of a telephone."""


def render(
    page: str,
    styles: Sequence[str] = STYLES,
    scripts: Sequence[str] = (),
    package: str = "faultpath.report",
    **content: object,
) -> str:
    """Return the template `page` with its styles and scripts inside, and the policy on them.

    All are looked for in the folder `templates` of `package`, and then in ours. Every template has
    `counted`, and `wording` as `w`.
    """
    environment, sources = _environment(package)
    texts = [
        "".join(sources.get_source(environment, name)[0] for name in names)
        for names in (styles, scripts)
    ]
    style, script = (
        f"sha256-{b64encode(hashlib.sha256(text.encode()).digest()).decode()}" for text in texts
    )
    # `data:` is the empty icon, without which a browser asks the server of the page for one.
    policy = (
        f"default-src 'none'; style-src '{style}'; script-src '{script}'; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )
    inside = {"policy": policy, "styles": Markup(texts[0]), "scripts": Markup(texts[1])}
    named = {"version": __version__, "w": wording, "counted": counted, **content}
    return environment.get_template(page).render(**inside, **named)


def write_pages(files: Mapping[str, str], folder: Path) -> list[Path]:
    """Write `report.html` and what belongs to it, each whole or not at all, and return the paths;
    `UserError` where that cannot be, or other files are there."""
    page = folder / "report.html"
    if page.is_file() and not page.is_symlink():
        check_mark(page, PAGE)
    elif not is_run(folder) and (
        others := [name for name in files if os.path.lexists(folder / name)]
    ):
        raise holds_others(folder, others[0])
    make_folder(folder)
    for name, text in files.items():
        write_text(folder / name, text, folder)
    return [folder / name for name in files]


@cache
def _environment(package: str) -> tuple[Environment, ChoiceLoader]:
    def shown(value: object) -> object:
        return visible(value) if isinstance(value, str) and not isinstance(value, Markup) else value

    sources = ChoiceLoader([PackageLoader(package), PackageLoader("faultpath.report")])
    blocks: dict[str, Any] = {"trim_blocks": True, "lstrip_blocks": True}
    strict: dict[str, Any] = {"autoescape": True, "undefined": StrictUndefined}
    environment = Environment(loader=sources, finalize=shown, **strict, **blocks)
    environment.filters["whole"] = whole  # pyright: ignore[reportUnknownMemberType]
    return environment, sources


def whole(text: str, names: Sequence[str]) -> Markup:
    """Return text in which no line breaks inside one of the short `names` of variants, nor between
    a number and its unit."""
    text = unbroken(text)
    short = sorted((name for name in names if 0 < len(name) <= _SHORT), key=len, reverse=True)
    if not short:
        return escape(visible(text))
    pattern = re.compile(rf"(?<![\w-])({'|'.join(map(re.escape, short))})(?![\w-])")
    parts = (escape(visible(part)) for part in pattern.split(text))
    return Markup("").join(
        Markup('<span class="whole">{}</span>').format(part) if place % 2 else part
        for place, part in enumerate(parts)
    )
