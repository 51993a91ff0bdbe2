"""Pages are closed to the network, and run and show our own styles and scripts alone."""

import hashlib
import re
from base64 import b64encode
from collections.abc import Iterator
from pathlib import Path

import pytest
from faultpath_paper.report.page import reproduction_page
from page_reader import Page
from playwright.sync_api import Browser
from reproduction_toys import reproduction

from faultpath.report.html import report_page
from faultpath.report.inputs import ReportInput


@pytest.fixture(scope="module", params=["report", "reproduction"])
def html(request: pytest.FixtureRequest, one_seed: ReportInput) -> str:
    if request.param == "report":
        return report_page(one_seed)
    return reproduction_page(reproduction(), one_seed.provenance, None)


def test_page_loads_nothing_escapes_names_and_links_lead_somewhere(html: str) -> None:
    page = Page(html)
    for _, attributes in page.tags:
        assert attributes.get("src") is None
        assert (attributes.get("href") or "#").startswith(("#", "data:,"))
    assert set(re.findall(r"https?://[^\s\"'<>)]+", html)) <= {"http://www.w3.org/2000/svg"}
    assert "@import" not in html
    assert set(re.findall(r"url\(([^)]*)\)", html)) <= set(re.findall(r"url\((#fig-[^)]*)\)", html))
    assert "<script>alert" not in html
    assert html.count("&lt;script&gt;alert") > 1
    assert len(page.ids) == len(set(page.ids))
    links = {a["href"] for tag, a in page.tags if tag == "a" and a.get("href")}
    inside = {link.removeprefix("#") for link in links if not link.startswith("#scene=")}
    assert inside - {"C26"} <= set(page.ids), "the toy's ledger has no C26"


def _policy(html: str) -> dict[str, str]:
    (found,) = re.findall(r'<meta http-equiv="Content-Security-Policy" content="([^"]*)">', html)
    return dict(part.split(maxsplit=1) for part in found.replace("&#39;", "'").split(";"))


def _digest(text: str) -> str:
    return f"'sha256-{b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def test_everything_is_forbidden_that_is_not_named(html: str) -> None:
    policy = _policy(html)
    for name in ("default-src", "base-uri", "form-action"):
        assert policy.pop(name) == "'none'"
    assert policy.pop("img-src") == "data:"
    assert set(policy) == {"style-src", "script-src"}
    assert "unsafe" not in " ".join(policy.values())


def test_styles_and_scripts_are_allowed_by_what_they_are(html: str) -> None:
    policy = _policy(html)
    styles = re.findall(r"<style>(.*?)</style>", html, re.DOTALL)
    scripts = re.findall(r"<script>(.*?)</script>", html, re.DOTALL)
    assert [_digest(text) for text in styles] == policy["style-src"].split()
    assert [_digest(text) for text in scripts or [""]] == policy["script-src"].split()


def test_nothing_runs_or_paints_from_an_attribute(html: str) -> None:
    outside = re.sub(r"<(style|script)\b.*?</\1>", "", html, flags=re.DOTALL)
    tags = re.findall(r"<[a-zA-Z][^>]*>", outside)
    assert len(tags) > 200
    for tag in tags:
        assert not re.search(r"\s(on\w+|style|srcdoc|formaction)\s*=", tag), tag
        assert "javascript:" not in tag.lower(), tag


@pytest.mark.browser
class TestInABrowser:
    """What the policy does where it counts."""

    @pytest.fixture
    def opened(self, browser: Browser, html: str, tmp_path: Path) -> Iterator[object]:
        context = browser.new_context(offline=True)

        def open_page(change: tuple[str, str]) -> tuple[object, list[str]]:
            place = tmp_path / "page.html"
            assert change[0] in html
            place.write_text(html.replace(*change, 1), encoding="utf-8")
            page = context.new_page()
            said: list[str] = []
            page.on("console", lambda message: said.append(message.text))
            page.on("pageerror", lambda error: said.append(str(error)))
            page.goto(place.as_uri())
            return page, said

        yield open_page
        context.close()

    def test_markup_that_came_through_would_do_nothing(self, opened) -> None:
        smuggled = (
            "<script>window.harm = 1</script><img src='data:,x' onerror='window.harm = 2'>"
            "<iframe srcdoc='<script>parent.harm = 3</script>'></iframe>"
            "<p id='painted' style='color: rgb(1, 2, 3)'>painted</p>"
            "<style>#painted { background: rgb(4, 5, 6) }</style>"
            "<a id='link' href='javascript:void(window.harm = 4)'>link</a>"
        )
        page, said = opened(("<main>", f"<main>{smuggled}"))
        page.locator("#link").click(force=True)
        assert page.evaluate("window.harm") is None
        paint = "(e) => [getComputedStyle(e).color, getComputedStyle(e).backgroundColor]"
        colours = page.locator("#painted").evaluate(paint)
        assert "rgb(1, 2, 3)" not in colours
        assert "rgb(4, 5, 6)" not in colours
        assert sum("Content Security Policy" in text for text in said) >= 4

    def test_a_policy_that_blocked_our_own_would_be_noticed(self, opened) -> None:
        _, quiet = opened(("<main>", "<main>"))
        assert quiet == []
        for place in ("style-src &#39;sha256-", "script-src &#39;sha256-"):
            _, said = opened((place, f"{place}x"))
            assert any("Content Security Policy" in text for text in said)
