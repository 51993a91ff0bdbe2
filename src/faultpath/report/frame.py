"""What every page is put into: one file that asks for nothing and runs nothing but our own scripts.

The page states its own content-security policy. Styles and scripts are allowed by their digests,
so that markup that a name might smuggle past the escapes neither runs nor loads anything: no other
script, no handler in an attribute, no style attribute, no picture, frame, form or connection.
"""

import hashlib
from base64 import b64encode
from collections.abc import Sequence
from functools import cache

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from faultpath.core.version import __version__
from faultpath.decisions.tables.escapes import visible
from faultpath.report.svg import template


def render(page: str, styles: Sequence[str], scripts: Sequence[str], **content: object) -> str:
    """Return the template `page` with its styles and scripts inside, and the policy on them."""
    style, script = ("".join(map(template, names)) for names in (styles, scripts))
    return (
        _environment()
        .get_template(page)
        .render(
            policy=_policy(style, script),
            styles=Markup(style),
            scripts=Markup(script),
            version=__version__,
            **content,
        )
    )


def _policy(style: str, script: str) -> str:
    # `data:` is the empty icon, without which a browser asks the server of the page for one.
    return (
        f"default-src 'none'; style-src '{_digest(style)}'; script-src '{_digest(script)}'; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )


def _digest(text: str) -> str:
    return f"sha256-{b64encode(hashlib.sha256(text.encode()).digest()).decode()}"


def _shown(value: object) -> object:
    return visible(value) if isinstance(value, str) and not isinstance(value, Markup) else value


@cache
def _environment() -> Environment:
    return Environment(
        loader=PackageLoader("faultpath.report"),
        autoescape=True,
        finalize=_shown,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
