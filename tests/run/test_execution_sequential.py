"""A plan that stops: at the same analysis with any number of workers, and wherever it was cut."""

from pathlib import Path

import pytest
from toy_plan import SCENES, plan, rows

from faultpath.core.errors import UserError
from faultpath.run.execution.runner import RunResult, run_plan
from faultpath.run.plan import Plan
from faultpath.run.trials import Trials

ORDER = ("s07", "s02", "s09", "s00", "s05", "s01", "s08", "s03", "s06", "s04")


def sequential(scenes: tuple[str, ...] = ORDER, batch: int = 2, **options: str) -> Plan:
    return plan(scenes, **options).model_copy(
        update={"scenes_per_analysis": batch, "rows": rows()[::3]}
    )


def seen(table: Trials) -> set[str]:
    return {row.outcome.scene for row in table}


def after(count: int) -> object:
    return lambda table: len(seen(table)) >= count


@pytest.fixture(scope="module")
def stopped(tmp_path_factory: pytest.TempPathFactory) -> tuple[RunResult, Path]:
    folder = tmp_path_factory.mktemp("stopped") / "run"
    return run_plan(sequential(), folder, workers=0, stop=after(6)), folder


def test_it_holds_the_first_scenes_of_its_order_and_no_others(stopped, tmp_path):
    result, _ = stopped
    assert seen(result.trials) == set(ORDER[:6])
    plain = run_plan(sequential(tuple(sorted(ORDER[:6])), batch=0), tmp_path, workers=0)
    assert result.outcomes_sha256 == plain.outcomes_sha256
    assert [row.taps for row in result.deliveries.rows] == [r.taps for r in plain.deliveries.rows]


def test_every_analysis_is_made_once_and_holds_all_scenes_before_it(tmp_path):
    analyses: list[set[str]] = []

    def stop(table: Trials) -> bool:
        analyses.append(seen(table))
        return False

    result = run_plan(sequential(batch=4), tmp_path, workers=2, stop=stop)
    assert analyses == [set(ORDER[:4]), set(ORDER[:8]), set(ORDER)]
    assert seen(result.trials) == set(SCENES)


def test_a_folder_is_not_both_of_a_fixed_number_and_sequential(stopped):
    _, folder = stopped
    with pytest.raises(UserError, match="number of scenes from analysis to analysis"):
        run_plan(sequential(batch=0), folder, workers=0)
