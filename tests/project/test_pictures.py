"""Pictures of documents: light or dark as their reader has it, and no label reaches out of them."""

from pathlib import Path
from xml.etree import ElementTree

import paper_blocks
import pictures

from faultpath import open_run
from faultpath.report.map_pictures import correlation_picture, map_picture
from faultpath.report.svg import text_width

ROOT = Path(__file__).resolve().parents[2]
SVG = "{http://www.w3.org/2000/svg}"
DARK = "@media screen and (prefers-color-scheme: dark)"


def test_labels_fit_and_colours_follow_the_reader() -> None:
    record = open_run(ROOT / "docs" / "reference" / "map-toy").record
    for picture in (map_picture(record), correlation_picture(record)):
        text = picture.render(standalone=True)
        assert DARK in text
        root = ElementTree.fromstring(text)
        left, _, width, _ = map(float, root.attrib["viewBox"].split())
        assert root.find(f".//{SVG}text[@class='head']") is not None
        for label in root.iter(f"{SVG}text"):
            words, at = label.text or "", float(label.attrib["x"])
            long = text_width(words, 11 if "small" in label.get("class", "") else 12)
            share = {"middle": 0.5, "end": 1.0}.get(label.get("text-anchor", ""), 0.0)
            assert at - share * long >= left - 1, words
            assert at + (1 - share) * long <= left + width + 1, words


def test_a_figure_of_the_paper_stands_alone_under_its_title() -> None:
    text = paper_blocks.picture("figure-3").svg
    root = ElementTree.fromstring(text)
    heads = [label.text for label in root.iter(f"{SVG}text") if label.get("class") == "head"]
    assert heads == [root.findtext(f"{SVG}title")]
    assert DARK in text


def test_a_picture_of_a_report_has_a_light_and_a_dark_side() -> None:
    both = pictures.twice((20.0, 10.0), "data:light", "data:dark")
    images = ElementTree.fromstring(both).iter(f"{SVG}image")
    assert [image.get("href") for image in images] == ["data:light", "data:dark"]
