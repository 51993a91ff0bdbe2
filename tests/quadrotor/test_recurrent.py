"""The learned wind reconstruction: what it reads, when, and that lanes do not mix."""

import pytest
import torch

from faultpath.quadrotor import so3
from faultpath.quadrotor.reconstruction import RecurrentReconstruction, WindNetwork

STATE = ("position", "velocity", "attitude", "body_rate")
HISTORY = {(channel, "history") for channel in (*STATE, "action")}
HEAD = {("mass", "head"), ("thrust_scale", "head")}


def network(calibrated=True):
    """A network with weights, and scales that are not the identity."""
    draw = torch.Generator().manual_seed(7)
    built = WindNetwork(calibrated)
    built.initialise(draw)
    built.measure(
        states=torch.randn(18, 13, 64, generator=draw) * 2 + 1,
        commands=torch.randn(4, 12, 64, generator=draw) + 9.81,
        calibration=torch.rand(2, 64, generator=draw) + 0.5,
        wind=4 * torch.randn(3, 64, generator=draw),
    )
    return built


def flight(steps, lanes=32, seed=0):
    """Readings of `steps` control steps."""
    draw = torch.Generator().manual_seed(seed)

    def normal(*shape):
        return torch.randn(*shape, lanes, generator=draw, dtype=torch.float64)

    readings = []
    for _ in range(steps):
        values = {
            "position": normal(3),
            "velocity": normal(3),
            "attitude": so3.exp(0.4 * normal(3)),
            "body_rate": normal(3),
            "action": normal(4) + 9.81,
        }
        step = {(channel, "history"): value for channel, value in values.items()}
        step |= {read: 1 + 0.2 * normal().tanh() for read in sorted(HEAD)}
        readings.append(step)
    return readings


def winds(module, readings):
    """The estimate at each step of a flight."""
    memory = module.begin(readings[0])
    estimates = [module.wind(memory)]
    for delivered in readings[1:]:
        memory = module.update(memory, delivered)
        estimates.append(module.wind(memory))
    return estimates


def changed(readings, step, read, value):
    """The same flight with one reading replaced."""
    return [{**r, read: value} if i == step else r for i, r in enumerate(readings)]


@pytest.mark.parametrize(("calibrated", "count"), [(True, 8963), (False, 8835)])
def test_parameter_count(calibrated, count):
    """GRU 96 x (22 + 32) with two biases; head (32 + 18 [+ 2]) x 64 x 3 (paper, appendix)."""
    assert sum(p.numel() for p in WindNetwork(calibrated).parameters()) == count


@pytest.mark.parametrize(("calibrated", "reads"), [(True, HISTORY | HEAD), (False, HISTORY)])
def test_it_reads_what_it_declares_and_nothing_else(calibrated, reads):
    seen = set()

    class Watched(dict):
        def __getitem__(self, read):
            seen.add(read)
            return super().__getitem__(read)

    module = RecurrentReconstruction(network(calibrated))
    winds(module, [Watched(delivered) for delivered in flight(3)])
    assert seen == module.reads == reads


def test_withheld_network_flies_where_no_calibration_is_delivered():
    module = RecurrentReconstruction(network(calibrated=False))
    bare = [{read: r[read] for read in HISTORY} for r in flight(14)]
    assert all(torch.isfinite(wind).all() for wind in winds(module, bare))


@pytest.mark.parametrize("steps", [1, 2, 5, 14])
def test_a_lane_does_not_depend_on_the_lanes_beside_it(steps):
    """Bit for bit: alone among copies of itself, moved, and in a batch of another size."""
    module = RecurrentReconstruction(network())
    readings = flight(steps, lanes=96)
    whole = winds(module, readings)[-1]
    for lanes in (torch.arange(32), torch.full((32,), 40), torch.arange(96).flip(0)):
        part = winds(module, [{k: v[..., lanes] for k, v in r.items()} for r in readings])[-1]
        assert torch.equal(part, whole[:, lanes])


def test_nothing_of_the_future_enters():
    readings, last = flight(16), flight(16, seed=1)[-1]
    module = RecurrentReconstruction(network())
    other = [*readings[:-1], last]
    one, two = winds(module, readings), winds(module, other)
    assert all(torch.equal(a, b) for a, b in zip(one[:-1], two[:-1], strict=True))
    assert not torch.equal(one[-1], two[-1])


def test_only_the_last_twelve_intervals_enter():
    """No hidden state is carried on: a reading is forgotten after its twelfth interval."""
    readings = flight(16)
    module = RecurrentReconstruction(network())
    before = winds(module, readings)
    for channel in (*STATE, "action"):
        read = (channel, "history")
        after = winds(module, changed(readings, 2, read, 3 * readings[2][read]))
        same = [torch.equal(a, b) for a, b in zip(before, after, strict=True)]
        assert same[:2] == [True, True]
        # The action of step 2 ended there; position enters relative to the latest.
        assert same[3:14] == [False] * 11
        assert same[14:] == [True, True]


def test_action_at_the_start_means_nothing():
    readings = flight(4)
    blank = torch.zeros(4, 32, dtype=torch.float64)
    module = RecurrentReconstruction(network())
    one = winds(module, readings)
    two = winds(module, changed(readings, 0, ("action", "history"), blank))
    assert all(torch.equal(a, b) for a, b in zip(one, two, strict=True))


def test_estimate_is_zero_until_an_interval_is_complete():
    start, after = winds(RecurrentReconstruction(network()), flight(2))
    assert torch.equal(start, torch.zeros(3, 32))
    assert after.abs().min() > 0


def test_position_enters_relative_to_the_latest():
    readings = flight(14)
    away = [{**r, ("position", "history"): r["position", "history"] + 64.0} for r in readings]
    module = RecurrentReconstruction(network())
    torch.testing.assert_close(winds(module, away)[-1], winds(module, readings)[-1])


def test_calibration_enters_as_last_delivered():
    readings = flight(14)
    module = RecurrentReconstruction(network())
    before = winds(module, readings)
    for read in HEAD:
        after = winds(module, changed(readings, 5, read, 1.3 * readings[5][read]))
        assert [i for i in range(14) if not torch.equal(before[i], after[i])] == [5]


@pytest.mark.parametrize("known", [0, 1, 7, 12])
def test_masked_history_equals_a_short_one(known):
    """Training masks the intervals that are not there; flight leaves them out."""
    built = network()
    draw = torch.Generator().manual_seed(3)
    intervals = torch.randn(22, 12, 32, generator=draw)
    masked = built.encode(intervals, torch.full((32,), known))
    assert torch.equal(masked, built.encode(intervals[:, 12 - known :]))


def test_gated_cell_is_the_gru_of_torch():
    """The loop over intervals gives what `torch.nn.GRU` gives with the same weights."""
    built = network()
    reference = torch.nn.GRU(22, 32)
    given, kept = built.encoder.from_input, built.encoder.from_latent
    reference.weight_ih_l0.data, reference.weight_hh_l0.data = given.weight.data, kept.weight.data
    reference.bias_ih_l0.data, reference.bias_hh_l0.data = given.bias[:, 0], kept.bias[:, 0]
    intervals = torch.randn(22, 12, 32, generator=torch.Generator().manual_seed(3))
    expected = reference(intervals.permute(1, 2, 0))[0][-1].T
    torch.testing.assert_close(built.encode(intervals), expected)


def test_scales_come_from_the_pool_and_stay():
    built = network()
    scales = {name: value.clone() for name, value in built.named_buffers()}
    assert set(scales) == {
        f"{part}_{what}" for part in ("feature", "calibration", "wind") for what in ("mean", "std")
    }
    winds(RecurrentReconstruction(built), flight(3))
    assert all(torch.equal(value, scales[name]) for name, value in built.named_buffers())


def test_wind_is_in_metres_per_second_and_not_clipped():
    built = network()
    with torch.no_grad():
        built.head.weight.zero_()
        built.head.bias.copy_(torch.tensor([[0.0], [1.0], [50.0]]))
    wind = winds(RecurrentReconstruction(built), flight(2))[-1]
    expected = built.wind_mean + torch.tensor([[0.0], [1.0], [50.0]]) * built.wind_std
    torch.testing.assert_close(wind, expected.expand(3, 32))
    assert wind.max() > 100
