"""What a pool of training episodes holds, whoever flies it and however often it is interrupted."""

import numpy as np
import pytest
from faultpath_quadrotor.platform import PLATFORM, FlightSettings
from faultpath_quadrotor.training import flight
from faultpath_quadrotor.training.flight import collect, fly
from faultpath_quadrotor.training.recorded import SIGNALS, FlightData
from faultpath_quadrotor.vehicle import COLLECTIVE_MAX_N, CONTROL_RATE_HZ, RATE_LIMIT_RADPS

from faultpath.core.errors import UserError

SMALL = {"nominal": 5, "wind": 7}


def of_length(patch, steps):
    patch.setattr(flight, "EPISODE_STEPS", steps)
    patch.setattr(flight, "EPISODE_S", steps / CONTROL_RATE_HZ)


@pytest.fixture(scope="module", autouse=True)
def short():
    """Ten steps an episode and three episodes a shard, in this process."""
    with pytest.MonkeyPatch.context() as patch:
        of_length(patch, 10)
        patch.setattr(flight, "BATCH", 3)
        yield


@pytest.fixture(scope="module")
def pools(short, tmp_path_factory):
    return collect(tmp_path_factory.mktemp("data"), workers=0, episodes=SMALL)


def contents(paths):
    return [path.read_bytes() for path in paths.values()]


def test_the_nominal_pool_is_still_and_the_wind_pool_has_the_collection_s_wind(pools):
    still, windy = FlightData.read(pools["nominal"]), FlightData.read(pools["wind"])
    assert not signal(still, "wind_mps").any()
    for episode, (first, steps) in enumerate(zip(windy.first_row, windy.steps, strict=True)):
        series = PLATFORM.winds.pool_series(0, episode, 6.1)
        expected = series[: 25 * steps + 1 : 25].astype(np.float32)
        blown = signal(windy, "wind_mps")[:, first : first + steps + 1]
        assert np.array_equal(blown, expected.T)


def test_the_result_does_not_depend_on_the_shards(pools, tmp_path, monkeypatch):
    monkeypatch.setattr(flight, "BATCH", 4)
    again = collect(tmp_path, workers=0, episodes=SMALL)
    for name, path in pools.items():
        one, two = FlightData.read(path), FlightData.read(again[name])
        for part in ("values", "steps"):
            assert np.array_equal(getattr(one, part), getattr(two, part), equal_nan=True)
        assert all(np.array_equal(one.vehicles[key], two.vehicles[key]) for key in one.vehicles)


def test_an_interrupted_collection_goes_on_and_ends_with_the_same_files(pools, tmp_path):
    def interrupt(done, _):
        if done > 0:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        collect(tmp_path, workers=0, episodes=SMALL, progress=interrupt)
    seen = []
    paths = collect(tmp_path, workers=0, episodes=SMALL, progress=lambda *told: seen.append(told))
    assert seen[0] == (3, 5)
    assert seen[-1] == (7, 7)
    assert contents(paths) == contents(pools)
    assert not any(path.is_dir() for path in tmp_path.iterdir())


def test_a_pool_of_another_seed_is_another_pool_and_is_kept(pools, tmp_path):
    path = collect(tmp_path, ("nominal",), 0, SMALL, seed=1)["nominal"]
    here, there = (FlightData.read(file).values[:, 0] for file in (path, pools["nominal"]))
    assert not np.array_equal(here, there)
    stamp, seen = path.stat().st_mtime_ns, []
    collect(tmp_path, ("nominal",), 0, SMALL, seed=1, progress=lambda *told: seen.append(told))
    assert (path.stat().st_mtime_ns, seen) == (stamp, [])
    with pytest.raises(UserError, match="collected with another 'seed'"):
        collect(tmp_path, ("nominal",), 0, SMALL, seed=2)


def test_mistakes_are_told(pools, tmp_path):
    with pytest.raises(UserError, match="no pool 'storm': choose from nominal, wind"):
        collect(tmp_path, pools=("storm",))
    with pytest.raises(UserError, match="cannot have 0 episodes"):
        collect(tmp_path, episodes={"wind": 0})
    with pytest.raises(UserError, match="no finished pool"):
        FlightData.read(tmp_path / "nominal.safetensors")
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError, match="choose a folder"):
        collect(tmp_path / "file")


@pytest.mark.parametrize("place", [0, 20, -1], ids=["length", "note", "last number"])
def test_a_damaged_pool_is_not_read(place, tmp_path):
    path = collect(tmp_path, ("nominal",), 0, {"nominal": 1})["nominal"]
    content = bytearray(path.read_bytes())
    content[place] ^= 1
    path.write_bytes(content)
    with pytest.raises(UserError, match="collect it again"):
        FlightData.read(path)


def signal(flights, name):
    return flights.values[SIGNALS[name]]


@pytest.mark.parametrize("pool", ["nominal", "wind"])
def test_an_episode_is_the_same_in_any_batch_to_the_bit(pool, monkeypatch):
    of_length(monkeypatch, 40)
    together = fly(pool, range(45), 3)
    for company in ([7], [40, 7, 0], list(range(7, 72))):
        other = fly(pool, company, 3)
        lane = company.index(7)
        assert np.array_equal(together.values[..., 7], other.values[..., lane], equal_nan=True)
        assert together.steps[7] == other.steps[lane]
        assert together.vehicles[7] == other.vehicles[lane]


def test_episodes_belong_to_pool_number_and_seed():
    keys = [("nominal", 0, 0), ("wind", 0, 0), ("nominal", 1, 0), ("nominal", 0, 1)]
    starts = [fly(pool, [episode], seed).values[:3, 0, 0] for pool, episode, seed in keys]
    assert len({tuple(start.tolist()) for start in starts}) == len(starts)


@pytest.mark.parametrize("pool", ["nominal", "wind"])
def test_commands_respect_the_vehicle_s_limits(pool):
    command = signal(fly(pool, range(32), 0), "command")[:, :-1]
    assert command[0].min() >= 0
    assert command[0].max() <= COLLECTIVE_MAX_N
    for axis, limit in enumerate(RATE_LIMIT_RADPS):
        assert np.abs(command[axis + 1]).max() <= limit


def test_an_episode_ends_with_its_last_state_in_bounds(monkeypatch):
    of_length(monkeypatch, 40)
    tight = PLATFORM.model_copy(update={"collection": FlightSettings(tilt_limit_deg=35.0)})
    monkeypatch.setattr(flight, "PLATFORM", tight)
    flights = fly("nominal", range(64), 0)
    short = np.flatnonzero(flights.steps < 40)
    assert len(short) > 10
    up = signal(flights, "rotation")[8]
    for lane in short:
        beyond = np.flatnonzero(up[1:, lane] <= np.cos(np.radians(35.0)))
        assert flights.steps[lane] == beyond[0]
