"""Recording and measuring end to end: stored once, resumed to the same bytes, read back."""

import numpy as np
import pytest
from faultpath_paper.evidence import quantities
from faultpath_paper.evidence.quantities import measure
from faultpath_paper.evidence.table import Measurement, Recording, read_evidence, write_evidence
from faultpath_quadrotor.scenes.library import SceneLibrary, as_text
from flights import hall

from faultpath.core.errors import UserError


@pytest.fixture(scope="module")
def library(tmp_path_factory) -> str:
    """Two halls to cross: flights of two to three seconds."""
    scenes = tuple(hall(i, (-4.0, i - 0.5, 1.5), (4.0, 0.0, 1.5)) for i in range(2))
    path = tmp_path_factory.mktemp("library") / "halls.json"
    path.write_text(as_text(SceneLibrary.of("halls", scenes)))
    return str(path)


@pytest.fixture(scope="module", autouse=True)
def small_blocks():
    """One scene a block, so that two scenes are two pieces of work."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(quantities, "BLOCK", 1)
        yield


def asked(library) -> list[Measurement]:
    flown = Recording(library=library, variant="dki-drag", options={"clearance": "true"})
    plain = Measurement(recording=flown, quantity="position-error", subject="dki", faults=())
    both = [plain, plain.model_copy(update={"faults": ("calibration=+0.1",)})]
    return [*both, *(each.model_copy(update={"subject": "wm-a"}) for each in both)]


@pytest.fixture(scope="module")
def whole(library, tmp_path_factory):
    """The folder of a run that nothing interrupted, and its table."""
    folder = tmp_path_factory.mktemp("whole")
    return folder, measure(asked(library), None, folder)


def contents(folder) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.name != ".lock"}


def test_all_subjects_have_the_same_windows_of_the_recorded_scenes(whole, library):
    _, table = whole
    assert list(table) == asked(library)
    first = table[asked(library)[0]]
    assert set(first.scenes) == {"halls/000", "halls/001"}
    assert first.scenes == tuple(sorted(first.scenes))
    for measurement in table:
        assert table[measurement].same_windows(first)


@pytest.mark.parametrize("stop", [1, 4])
def test_a_killed_run_goes_on_to_the_same_bytes(whole, library, stop, tmp_path):
    folder, _ = whole

    def killing(done: float, total: float) -> None:
        assert total == 6
        if done == stop:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        measure(asked(library), None, tmp_path, 0, killing)
    kept = contents(tmp_path)
    assert 0 < len(kept) < len(contents(folder))
    told = []
    measure(asked(library), None, tmp_path, 0, lambda done, total: told.append((done, total)))
    assert told[0] == (0, 6 - stop)
    assert contents(tmp_path) == contents(folder)


def test_a_second_call_does_nothing_and_more_scenes_keep_what_is_there(whole, library, tmp_path):
    folder, table = whole
    told = []
    again = measure(asked(library), 2, folder, 0, lambda done, total: told.append(total))
    assert told == [0]
    for measurement in table:
        assert np.array_equal(again[measurement].values, table[measurement].values)
    one = asked(library)[:1]
    measure(one, 1, tmp_path)
    flown = {path.name for path in tmp_path.glob("*.safetensors")}
    measure(one, 2, tmp_path)
    assert flown < {path.name for path in tmp_path.glob("*.safetensors")}
    few = measure(one, 1, tmp_path)[one[0]]
    both = table[one[0]]
    assert np.array_equal(few.values, both.values[: len(few)])


def test_a_table_comes_back_as_it_went_with_the_same_bytes(whole, library, tmp_path):
    _, table = whole
    path, again = tmp_path / "evidence.parquet", tmp_path / "again.parquet"
    write_evidence(path, table)
    back = read_evidence(path)
    assert list(back) == list(table)
    for measurement in table:
        one, two = table[measurement], back[measurement]
        assert one.same_windows(two)
        assert np.array_equal(one.values, two.values)
    write_evidence(again, back)
    assert again.read_bytes() == path.read_bytes()
    with pytest.raises(KeyError):
        back[asked(library)[0].model_copy(update={"seed": 2})]
    with pytest.raises(UserError, match="cannot read"):
        read_evidence(tmp_path / "none.parquet")
    path.write_bytes(b"odd")
    with pytest.raises(UserError, match="damaged"):
        read_evidence(path)
