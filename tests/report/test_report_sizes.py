"""Sizes in words: of a claim, of a ledger, on the page, in the terminal and in Markdown."""

import pytest
from faultpath_paper.answers import ClaimVerdict
from faultpath_paper.report import words
from reproduction_toys import claim, ledger, part


def sized(*sizes: str) -> ClaimVerdict:
    """Return a claim whose parts have these sizes; an empty one has no figure in the paper."""
    numbers = {"estimate": 5.0, "interval": (4.0, 6.0), "unit": "pp"}
    parts = (
        part("confirmed", **numbers, **({"paper": 3.0, "size": size} if size else {}))
        for size in sizes
    )
    return claim("C01", "finding", tuple(parts))


SAME, OTHER = "right sign, other size", "other sign"


@pytest.mark.parametrize(
    ("sizes", "text"),
    [
        ((), ""),
        (("",), ""),
        (("", "not comparable"), "cannot be compared"),
        (("compatible", ""), "1 figure agrees"),
        (("compatible", "compatible"), "2 figures agree"),
        (
            (SAME, "compatible", SAME, "not comparable"),
            "1 figure agrees, 2 have the same direction but a different size",
        ),
        (
            (OTHER, "other size", "compatible"),
            "1 figure agrees, 1 has a different size, 1 points in the opposite direction",
        ),
    ],
)
def test_the_figures_of_a_claim_are_counted_in_plain_words(
    sizes: tuple[str, ...], text: str
) -> None:
    found = sized(*sizes) if sizes else sized("").model_copy(update={"parts": ()})
    assert words.size(found) == text


def test_sizes_are_counted_in_a_sentence() -> None:
    sizes = [(SAME, "compatible"), (OTHER, "compatible", "not comparable")]
    found = ledger().model_copy(update={"claims": tuple(sized(*each) for each in sizes)})
    assert words.sizes(found) == (
        "The paper prints 5 figures for these claims, of which 4 can be compared with ours: "
        "2 figures agree, 1 has the same direction but a different size, 1 points in the opposite "
        "direction."
    )
