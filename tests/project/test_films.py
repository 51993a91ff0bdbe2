"""Pictures and films of the documents: whole, small, and showing what the stored run says."""

import re
from pathlib import Path
from xml.etree import ElementTree

import film_flights
import film_halves
import film_openpilot
import film_quadrotor
import paper_blocks
import pictures
import pytest
from blocks import IMAGES, Picture, Wrong, load

from faultpath.report.svg import text_width

ROOT = Path(__file__).resolve().parents[2]
SVG = "{http://www.w3.org/2000/svg}"
DARK = "@media screen and (prefers-color-scheme: dark)"
FILMS = {"quadrotor": film_quadrotor.film, "openpilot": film_openpilot.film}
SIZES = {"small": 11, "title": 15, "name": 13, "clock": 17}
STORED = film_flights.Flights.model_validate_json(film_flights.FLIGHTS.read_bytes())


def labels(svg: str) -> list[ElementTree.Element]:
    return list(ElementTree.fromstring(svg).iter(f"{SVG}text"))


@pytest.fixture(params=FILMS)
def film(request: pytest.FixtureRequest) -> Picture:
    return FILMS[request.param]()


def test_a_film_is_a_small_file_with_a_still_beside_it(film: Picture) -> None:
    assert [path.name for path in film.files] == [film.name, film.name.replace(".", "-still.")]
    assert max(map(len, film.files.values())) < 1_000_000


def test_a_film_moves_without_a_script_and_its_still_does_not(film: Picture) -> None:
    moving = [set(re.findall(rf"{word} (m\d+)", film.svg)) for word in ("animation:", "@keyframes")]
    moving[0] |= set(re.findall(r"animation:(m\d+)", film.svg))
    used = {
        name
        for node in ElementTree.fromstring(film.svg).iter()
        for name in node.get("class", "").split()
        if re.fullmatch(r"m\d+", name)
    }
    assert moving[0] == moving[1] == used
    assert "infinite" in film.svg
    assert "animation" not in film.still
    for svg in (film.svg, film.still):
        assert "<script" not in svg
        assert DARK in svg
    assert [text.text for text in labels(film.svg)] == [text.text for text in labels(film.still)]


def test_labels_stay_in_the_picture(film: Picture) -> None:
    root = ElementTree.fromstring(film.svg)
    left, _, width, _ = map(float, root.attrib["viewBox"].split())
    for label in labels(film.svg):
        words, at = label.text or "", float(label.attrib["x"])
        size = next((SIZES[n] for n in label.get("class", "").split() if n in SIZES), 12)
        share = {"middle": 0.5, "end": 1.0}.get(label.get("text-anchor", ""), 0.0)
        long = text_width(words, size)
        assert left <= at - share * long <= at + (1 - share) * long <= left + width, words


@pytest.mark.parametrize(
    ("film", "run"),
    [("quadrotor", film_flights.RUN), ("openpilot", film_openpilot.STORY.run)],
)
def test_a_film_has_the_rates_and_effects_of_all_scenes(film: str, run: str) -> None:
    words = {label.text or "" for label in labels(FILMS[film]().svg)}
    effects = {effect.condition: effect for effect in load(run).record.effects}
    stories = {"quadrotor": film_quadrotor.story_of(STORED), "openpilot": film_openpilot.STORY}
    for half in stories[film].halves:
        effect = effects[half.condition]
        assert {f"{rate:.1f} %" for rate in effect.rates} <= words
        (said,) = (text for text in words if f"{abs(effect.value):.1f} pp" in text)
        assert ("ahead by" in said) == effect.significant


def test_a_document_shows_the_still_to_readers_who_prefer_no_motion() -> None:
    page = (ROOT / "README.md").read_text("utf-8")
    name, still = IMAGES / "film-quadrotor.svg", IMAGES / "film-quadrotor-still.svg"
    first = page.index("<picture>")
    assert "![" not in page[:first]
    source, image = page[first:].splitlines()[1:3]
    assert source.startswith('<source media="(prefers-reduced-motion: reduce)" srcset="docs/')
    assert source.endswith(f'{still.name}">')
    assert image.endswith(f'src="docs/images/{name.name}">')


def test_a_scene_that_shows_something_else_is_refused() -> None:
    with pytest.raises(Wrong, match="choose another scene"):
        film_halves.caption(film_openpilot.STORY.model_copy(update={"scene": "seed/1000"}))


def test_flights_of_another_run_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "film_flights.json"
    first, *others = STORED.flights
    short = first.model_copy(update={"places_cm": first.places_cm[:-1]})
    path.write_text(STORED.model_copy(update={"flights": [short, *others]}).model_dump_json())
    monkeypatch.setattr(film_quadrotor, "FLIGHTS", path)
    with pytest.raises(Wrong, match=r"make it with tools/film_flights\.py"):
        film_quadrotor.film.__wrapped__()
    with pytest.raises(Wrong, match="no scene decision/999 with seed 2"):
        film_flights.flown("decision/999", 2)


@pytest.mark.slow
def test_the_flights_repeat() -> None:
    assert film_flights.flown(STORED.scene, STORED.seed) == STORED


def test_a_figure_of_the_paper_stands_alone_under_its_title() -> None:
    text = paper_blocks.picture("figure-3").svg
    root = ElementTree.fromstring(text)
    heads = [label.text for label in labels(text) if label.get("class") == "head"]
    assert heads == [root.findtext(f"{SVG}title")]
    assert DARK in text


def test_a_picture_of_a_report_has_a_light_and_a_dark_side() -> None:
    both = pictures.twice((20.0, 10.0), "data:light", "data:dark")
    images = ElementTree.fromstring(both).iter(f"{SVG}image")
    assert [image.get("href") for image in images] == ["data:light", "data:dark"]
