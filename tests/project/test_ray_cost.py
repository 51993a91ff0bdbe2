"""What the page on many trials makes of a measurement of Ray."""

from pathlib import Path

TOOLS = Path(__file__).resolve().parents[2] / "tools"


def test_prices_are_those_of_the_trials_that_one_audit_has_beyond_the_other(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(TOOLS))
    import ray_cost
    from ray_cost import Cost, Spent, Timed

    timed = [
        Timed(
            case="toy",
            executor=executor,
            workers=workers,
            few=Spent(trials=1000, wall_s=5.0, driver_s=2.0),
            more=Spent(trials=11_000, wall_s=5.0 + 36 / workers, driver_s=11.0),
            others={"ray": None, "local": 0.01 * workers}[executor],
        )
        for workers in ray_cost.WORKERS
        for executor in ("local", "ray")
    ]
    about = {"date": "today", "processor": "a processor", "cores": 2, "ray": "2.60.0"}
    cost = Cost(**about, commit=None, dirty=True, timed=tuple(timed))
    monkeypatch.setattr(ray_cost, "RESULT", tmp_path / "cost.json")
    assert ray_cost.fill().startswith("*Not measured yet")
    ray_cost.RESULT.write_text(cost.model_dump_json())
    page = ray_cost.fill()
    assert "**The machine was busy**: other work took 4.0 % of the processor's time" in page
    assert "| `toy` | processes | 1 | 1.4 | 277.8 | 0.90 | 1.0 |" in page
    assert "| `toy` | Ray | 4 | 4.1 | 1111.1 | 0.90 | 0.2 |" in page
    # At 0.9 ms a trial the driver bounds what more workers gain.
    assert "| toy | 1.0 | 0.25 | 0.25 | 0.25 | 4 workers |" in page
    assert "| toy, were each 1 s longer | 278.8 | 4.36 | 1.09 | 0.27 | 1115 workers |" in page
