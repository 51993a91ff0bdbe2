"""Pictures of documents: light or dark as their reader has it, and no label reaches out of them."""

import re
from pathlib import Path
from xml.etree import ElementTree

import pictures

from faultpath import open_run
from faultpath.report.map_pictures import correlation_picture, map_picture
from faultpath.report.svg import text_width

ROOT = Path(__file__).resolve().parents[2]
SVG = "{http://www.w3.org/2000/svg}"
DARK = "@media screen and (prefers-color-scheme: dark)"


def drawn() -> dict[str, str]:
    """The pictures that follow from numbers, by name."""
    record = open_run(ROOT / "docs" / "reference" / "map-toy").record
    maps = {"map.svg": map_picture(record), "correlation.svg": correlation_picture(record)}
    return {name: svg.render(standalone=True) for name, svg in maps.items()}


def test_labels_fit_and_colours_follow_the_reader() -> None:
    for name, text in drawn().items():
        assert DARK in text, name
        root = ElementTree.fromstring(text)
        left, _, width, _ = map(float, root.attrib["viewBox"].split())
        assert root.find(f".//{SVG}text[@class='head']") is not None, f"{name} has no title"
        for label in root.iter(f"{SVG}text"):
            words, at = label.text or "", float(label.attrib["x"])
            size = 11 if "small" in label.get("class", "") else 12
            long = text_width(words, size)
            share = {"middle": 0.5, "end": 1.0}.get(label.get("text-anchor", ""), 0.0)
            assert at - share * long >= left - 1, f"{name}: {words}"
            assert at + (1 - share) * long <= left + width + 1, f"{name}: {words}"


def test_a_drawing_of_a_page_stands_alone_under_its_title() -> None:
    page = (ROOT / "docs" / "reference" / "toy" / "report.html").read_text("utf-8")
    drawing = re.search(r"<svg.*?</svg>", page, re.DOTALL)
    assert drawing is not None

    def heads(text: str) -> list[str | None]:
        root = ElementTree.fromstring(text)
        return [each.text for each in root.iter(f"{SVG}text") if each.get("class") == "head"]

    own = heads(drawing[0])
    assert len(own) == 1
    text = pictures.standing(drawing[0])
    assert heads(text) == own  # another one above it would say the same again
    without = drawing[0].replace('class="head"', 'class="bold"')
    title = ElementTree.fromstring(without).findtext(f"{SVG}title")
    assert heads(pictures.standing(without)) == [title]
    assert DARK in text
    both = pictures.twice((20.0, 10.0), "data:light", "data:dark")
    assert [each.get("href") for each in ElementTree.fromstring(both).iter(f"{SVG}image")] == [
        "data:light",
        "data:dark",
    ]
