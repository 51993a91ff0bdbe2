"""The toy with declared uncertainties, and with a third module that reads the gain."""

from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

from faultpath.loop import Module, Port, interface_of
from faultpath.system import System, Wiring

TOY = Path(__file__).resolve().parents[2] / "examples" / "toy.py"
_spec = spec_from_file_location("toy_of_the_examples", TOY)
toy = module_from_spec(_spec)
_spec.loader.exec_module(toy)

UNCERTAIN = {
    "unit: '1', provenance: estimated": "uncertainty: {half_range: 0.25, relative: true}",
    "unit: m/s, provenance: measured": "uncertainty: {std: 0.1}",
    "unit: m/s^2, provenance: reconstructed": "uncertainty: {std: 0.2}",
}


def facts() -> str:
    text = toy.FACTS
    for old, more in UNCERTAIN.items():
        assert old in text
        text = text.replace(old, f"{old}, {more}")
    return text


class Logger(Module):
    """Reads the gain and does nothing with it."""

    name, reads = "logger", frozenset({Port("gain", "file")})

    def step(self, inputs, memory):
        return {}, memory


PARTS = (toy.Controller(), toy.Observer(calibrated=True), toy.Cart())


class Declared(toy.Toy):
    name, interface = "declared", interface_of(facts(), PARTS)


class Logged(toy.Toy):
    """Three modules read the gain; `logged` is `blind` but for that."""

    name, interface = "logged", interface_of(facts(), (*PARTS, Logger()))
    wirings = {**toy.Toy.wirings, "logged": Wiring("Blind, with a log.")}  # noqa: RUF012 - never changed

    def modules(self, variant, seed):
        more = (Logger(),) if variant == "logged" else ()
        return (*super().modules("blind" if more else variant, seed), *more)


def create() -> System:
    return Declared()


def logged() -> System:
    return Logged()
