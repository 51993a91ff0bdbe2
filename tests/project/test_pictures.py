"""Pictures of documents: light or dark as their reader has it."""

from xml.etree import ElementTree

import paper_blocks
import pictures

SVG = "{http://www.w3.org/2000/svg}"
DARK = "@media screen and (prefers-color-scheme: dark)"


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
