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
    ("sizes", "said"),
    [
        ((), ""),
        (("",), ""),
        (("", "not comparable"), "not comparable"),
        (("compatible", ""), "compatible"),
        (("compatible", "compatible"), "compatible, 2 of 2"),
        ((SAME, "compatible", SAME, "not comparable"), f"{SAME}, 2 of 3"),
        ((SAME, "other size", "compatible"), "other size, 1 of 3"),
        ((OTHER, "other size", SAME, "compatible"), f"{OTHER}, 1 of 4"),
    ],
)
def test_the_size_of_a_claim_is_that_of_its_farthest_part(
    sizes: tuple[str, ...], said: str
) -> None:
    found = sized(*sizes) if sizes else sized("").model_copy(update={"parts": ()})
    assert words.size(found) == said


def test_sizes_are_counted_in_a_sentence() -> None:
    sizes = [(SAME, "compatible"), (OTHER, "compatible", "not comparable")]
    found = ledger().model_copy(update={"claims": tuple(sized(*each) for each in sizes)})
    assert words.sizes(found) == (
        "The paper prints 5 figures for these claims, of which 4 can be compared: "
        f"2 compatible; 1 {SAME}; 1 {OTHER}."
    )
