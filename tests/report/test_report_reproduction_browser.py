"""The page of a reproduction in a real browser: it fits, filters, opens and stays quiet."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, expect
from reproduction_toys import ledger, source

from faultpath.report.inputs import ReportInput
from faultpath.report.reproduction.page import reproduction_page

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def address(one_seed: ReportInput, tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("reproduction") / "reproduction.html"
    path.write_text(reproduction_page(source(one_seed)), encoding="utf-8")
    return path.as_uri()


@pytest.fixture(
    params=[(1280, "light", True), (380, "dark", True), (1280, "light", False)],
    ids=["desktop", "telephone", "without scripts"],
)
def page(request: pytest.FixtureRequest, browser: Browser, address: str) -> Iterator[Page]:
    width, scheme, scripts = request.param
    context: BrowserContext = browser.new_context(
        viewport={"width": width, "height": 900},
        color_scheme=scheme,
        offline=True,
        reduced_motion="reduce",
        java_script_enabled=scripts,
    )
    opened = context.new_page()
    troubles: list[str] = []
    opened.on("console", lambda message: troubles.append(message.text))
    opened.on("pageerror", lambda error: troubles.append(str(error)))
    opened.on("dialog", lambda dialog: troubles.append(f"dialog: {dialog.message}"))
    opened.on(
        "request", lambda sent: None if sent.url.startswith(address) else troubles.append(sent.url)
    )
    opened.goto(address)
    yield opened
    context.close()
    assert [trouble for trouble in troubles if not trouble.startswith("data:,")] == []


def test_nothing_sticks_out_and_pictures_have_a_size(page: Page) -> None:
    sideways = page.locator("html").evaluate("(e) => e.scrollWidth - e.clientWidth")
    assert sideways <= 0
    sizes = page.locator("svg.fig:visible").evaluate_all(
        "(all) => all.map((e) => e.getBoundingClientRect()).map((r) => [r.width, r.height])"
    )
    assert len(sizes) > 8
    assert all(min(size) > 8 for size in sizes)


def test_claims_are_filtered_by_verdict_and_kind(page: Page) -> None:
    claims = ledger().claims
    for verdict in ("refuted", "undecided", "confirmed"):
        page.locator(f"#only-{verdict}").check()
        shown = page.locator("details.claim:visible").evaluate_all("(all) => all.map((c) => c.id)")
        assert shown == [claim.id for claim in claims if claim.verdict == verdict]
    page.locator("#only-all").check()
    page.locator("#size-none").check()
    assert page.locator("details.claim:visible").count() == len(claims)
    page.locator("#kind-platform").focus()
    page.keyboard.press("Space")
    assert page.locator("details.claim:visible").count() == 1


def test_a_claim_opens_to_its_parts_by_key(page: Page) -> None:
    parts = page.locator("#C01 .parts li")
    assert not parts.first.is_visible()
    page.locator("#C01 summary").focus()
    page.keyboard.press("Enter")
    assert parts.count() == 2
    assert parts.last.is_visible()


def test_the_papers_figures_can_be_put_away(page: Page) -> None:
    theirs = page.locator("#table-1 .theirs").first
    assert theirs.is_visible()
    page.locator("#theirs").uncheck()
    assert not theirs.is_visible()


def test_a_link_leads_to_its_claim_and_a_script_opens_it(
    page: Page, request: pytest.FixtureRequest
) -> None:
    scripts = request.node.callspec.params["page"][2]
    if scripts:
        page.locator("#only-confirmed").check()
    page.locator('a.mark[href="#C03"]').click()
    expect(page.locator("#C03 summary")).to_be_in_viewport()
    expect(page.locator("#C03 .parts")).to_be_visible(visible=scripts)


def test_contents_stay_in_sight(page: Page) -> None:
    page.locator("#provenance").scroll_into_view_if_needed()
    box = page.get_by_role("navigation", name="Contents").bounding_box()
    assert box is not None
    assert abs(box["y"]) < 60
