"""What is said of a name that does not exist: the nearest one, and never a wall of names."""

from faultpath.text import unknown


def test_few_names_are_all_told() -> None:
    assert unknown("gear", "seconf", ["first", "second"]) == (
        "unknown gear 'seconf'; did you mean 'second'? known: first, second"
    )
    assert unknown("gear", "", []) == "unknown gear ''; known: none"


def test_of_many_names_the_nearest_are_told() -> None:
    names = [f"{model}/{wind}" for model in "abcdefg" for wind in ("dob", "gru", "true-wind")]
    said = unknown("variant", "c/gruu", names)
    assert "did you mean 'c/gru'? known: " in said
    assert said.endswith(" and 13 more")
    assert said.count("/gru,") >= 6
    far = unknown("variant", "nothing like it", names)
    assert "did you mean" not in far
    assert far.endswith(" and 13 more")


def test_twenty_names_are_no_wall() -> None:
    names = [f"name{n}" for n in range(20)]
    assert "more" not in unknown("name", "no", names)
    assert "and 13 more" in unknown("name", "no", [*names, "name20"])
