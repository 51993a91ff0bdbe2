"""The installed package is found by its names."""

import faultpath


def test_a_sensor_that_saturates_costs_success(tmp_path):
    run = faultpath.audit(
        "tank",
        baseline="slow",
        repair="quick",
        fault="level:saturate=1.4",
        scenes=20,
        workers=0,
        folder=tmp_path / "run",
        progress=False,
    )
    trials = run.table().to_pylist()
    successes = {"correct": 0, "shared": 0, "observer": 0, "valve": 0}
    for trial in trials:
        successes[trial["condition"]] += trial["status"] == "success"
    assert successes["shared"] < successes["correct"]
    assert faultpath.open_run(run.folder).record == run.record
