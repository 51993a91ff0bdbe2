"""Text stands out from its ground in both colour schemes (WCAG 2, level AA)."""

import re

import pytest

from faultpath.report.svg import template

TEXT = ("ink", "soft", "repair", "baseline", "faulted", "link")
GROUNDS = ("paper", "wash")


def _schemes() -> dict[str, dict[str, str]]:
    css = template("tokens.css")
    light, dark = css.split("@media", 1)
    found = [dict(re.findall(r"--([a-z-]+): (#[0-9a-f]{6});", part)) for part in (light, dark)]
    return {"light": found[0], "dark": found[1]}


def _luminance(colour: str) -> float:
    parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def _contrast(a: str, b: str) -> float:
    high, low = sorted((_luminance(a), _luminance(b)), reverse=True)
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_has_contrast(scheme: str) -> None:
    colours = _schemes()[scheme]
    pairs = [(text, ground) for text in TEXT for ground in GROUNDS]
    pairs += [("paper", "ink"), ("paper", "faulted"), ("paper", "good"), ("ink", "faint")]
    pairs += [("ink", "faulted-wash"), ("faulted", "faulted-wash")]
    weak = {p: _contrast(colours[p[0]], colours[p[1]]) for p in pairs}
    assert {p: round(c, 2) for p, c in weak.items() if c < 4.5} == {}


def test_both_schemes_name_the_same_colours() -> None:
    light, dark = _schemes().values()
    assert set(light) == set(dark)
