"""The learned wind reconstruction: when it reads what, and that its unit is the GRU of torch."""

import torch
from faultpath_quadrotor import so3
from faultpath_quadrotor.reconstruction import RecurrentReconstruction, WindNetwork

HEAD = ("mass", "head"), ("thrust_scale", "head")


def network():
    """A network with weights, and scales that are not the identity."""
    draw = torch.Generator().manual_seed(7)
    built = WindNetwork(calibrated=True)
    built.initialise(draw)
    built.measure(
        states=torch.randn(18, 12, 64, generator=draw) * 2 + 1,
        commands=torch.randn(4, 12, 64, generator=draw) + 9.81,
        calibration=torch.rand(2, 64, generator=draw) + 0.5,
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
        step |= {read: 1 + 0.2 * normal().tanh() for read in HEAD}
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


def test_a_vehicle_that_goes_on_as_before_its_flight_keeps_its_estimate():
    """The intervals before the flight are those of the hover that was executed then."""
    module = RecurrentReconstruction(network())
    estimates = winds(module, flight(1) * 5)
    assert all(torch.equal(estimate, estimates[0]) for estimate in estimates)


def test_nothing_of_the_future_enters():
    readings, last = flight(16), flight(16, seed=1)[-1]
    module = RecurrentReconstruction(network())
    other = [*readings[:-1], last]
    one, two = winds(module, readings), winds(module, other)
    assert all(torch.equal(a, b) for a, b in zip(one[:-1], two[:-1], strict=True))
    assert not torch.equal(one[-1], two[-1])


def test_gated_cell_is_the_gru_of_torch():
    """The loop over intervals gives what `torch.nn.GRU` gives with the same weights."""
    built = network()
    reference = torch.nn.GRU(22, 32)
    given, kept = built.encoder.from_input, built.encoder.from_latent
    reference.weight_ih_l0.data, reference.weight_hh_l0.data = given.weight.data, kept.weight.data
    reference.bias_ih_l0.data, reference.bias_hh_l0.data = given.bias[:, 0], kept.bias[:, 0]
    intervals = torch.randn(22, 12, 32, generator=torch.Generator().manual_seed(3))
    expected = reference(intervals.permute(1, 2, 0))[0][-1].T
    torch.testing.assert_close(built.encoder.last(intervals.movedim(1, 0)), expected)
