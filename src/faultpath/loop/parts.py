"""The parts of a closed loop: modules that read and write, and the plant under them."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple, TypeAlias

from faultpath.core.arrays import Array
from faultpath.loop.reading import IllegalRead, UndeclaredReader

Memory: TypeAlias = Any
"""Values that a module carries from step to step; opaque to all other code."""

State: TypeAlias = Any
"""Values that a plant carries from step to step; opaque to all other code."""

Outputs: TypeAlias = Mapping[str, Any]
"""By source: an array `[B, ...]`, or a `faultpath.loop.Query` to be called within the step."""


class Port(NamedTuple):
    """A channel and the place in the module where it enters: one tap.

    A channel at two places makes two ports, so that a fault can reach one of them alone. A module
    that runs other modules inside it names their places in full, `observer.flux`, because they are
    readers of their own.
    """

    channel: str
    place: str


class Inputs(dict[tuple[str, str], Any]):
    """Deliveries of the taps to one module at one step: an entry for each of its ports.

    A signal is an array `[B, ...]`, one row a scene; a query is a function of a request. A port
    that the module did not declare has no entry: looking for one raises `UndeclaredReader`.
    """

    def __init__(
        self,
        module: str,
        step: int,
        delivered: Mapping[tuple[str, str], Any],
        truths: Mapping[str, Any],
        running: Array = None,
        at_read: Mapping[Port, Callable[..., Any]] | None = None,
        label: str = "",
    ) -> None:
        super().__init__(delivered)
        self.module = module
        self._label = label or f"module '{module}'"
        self.step = step
        """Control step, from 0."""
        self.running = running
        """Which scenes still run, bool `[B]`, so that a module can skip the others; `None`: all."""
        self.at_read = at_read or {}
        """Deliveries that happen only when a port is accessed, by all scenes or by one."""
        self._truths = truths

    def __missing__(self, port: tuple[str, str]) -> Any:
        channel, place = port
        if deliver := self.at_read.get(Port(channel, place)):
            self[port] = value = deliver()
            return value
        raise UndeclaredReader(
            f"{self._label} looked for channel '{channel}' at '{place}', a port that it "
            f"does not declare: add Port('{channel}', '{place}') to its reads"
        )

    def row(self, port: Port, scene: int) -> Any:
        """Return what one scene gets at a port; no other scene of the batch counts as reading."""
        if port not in self and (deliver := self.at_read.get(port)):
            return deliver(scene)[scene]
        return self[port][scene]

    def truth(self, name: str) -> Any:
        """Return a truth that the plant shows; `IllegalRead` for an undeclared one."""
        if name not in self._truths:
            raise IllegalRead(
                f"{self._label} looked for the plant's truth '{name}', which it does not "
                "declare: add it to its truths"
            )
        return self._truths[name]


@dataclass(frozen=True)
class Batch:
    """The trials that one execution of a loop runs side by side."""

    scenes: tuple[str, ...]
    seed: int
    """Seed of random numbers and, where models are trained, of their training."""
    dt_s: float
    """Length of a control step, s."""


class Part(ABC):
    """A part of a loop, which reads at ports."""

    name: str
    """Name under which the interface lists its readers, `name.place`. Parts may share one; a fault
    at that module then reaches all of them."""
    reads: frozenset[Port] = frozenset()
    """Ports that get their source's value of this step."""
    reads_past: frozenset[Port] = frozenset()
    """Ports that get their source's value of the step before, which closes cycles. At the first
    step they get `before` of the source's module."""
    at_read: frozenset[Port] = frozenset()
    """Ports that get a reading only in steps in which the module accesses it, so that the delivery
    log counts reads."""

    writes: tuple[str, ...] = ()
    """Sources of the interface that it produces at every step; a plant senses its sources."""

    def __str__(self) -> str:
        return self.name

    @property
    def ports(self) -> frozenset[Port]:
        """Ports of this step and of the step before."""
        return self.reads | self.reads_past

    def reader(self, port: Port) -> str:
        """Return the name `module.place` under which the interface lists a port."""
        return port.place if "." in port.place else f"{self.name}.{port.place}"


class Module(Part):
    """A part of the controller: readings and memory in, sources and memory out.

    It keeps no state outside its memory, does not write into its inputs, and gives each scene a
    result that does not depend on the other scenes of the batch. Random numbers come
    from `faultpath.core.streams`, by scene, seed and step.
    """

    truths: tuple[str, ...] = ()
    """Parts of the plant's own state that it reads past all taps. Only an override of an estimator
    does so, and `trace` names it."""

    def begin(self, batch: Batch) -> Memory:
        """Return the memory before the first step."""
        del batch

    @abstractmethod
    def step(self, inputs: Inputs, memory: Memory) -> tuple[Outputs, Memory]:
        """Return the value of each of `writes`, and the memory for the next step."""

    def before(self, batch: Batch) -> Outputs:
        """Return its sources' values before the first step, for ports that read the past."""
        del batch
        return {}

    def noise_hashes(self, batch: Batch) -> Sequence[str] | None:
        """Return a hash of its random numbers in each scene; `None` if it draws none.

        Two trials are a pair only where these hashes agree.
        """
        del batch
        return None


@dataclass(frozen=True)
class Progress:
    """State of each scene's trial, `[B]` each; ended trials keep their final values."""

    running: Array
    succeeded: Array
    crashed: Array
    """A trial that neither succeeded nor crashed has timed out."""
    time_s: Array
    """Time at which the trial ended, or the present time."""
    metrics: Mapping[str, Array] = field(default_factory=dict[str, Array])
    """Further measurements by name, `[B]` each."""


class Plant(Part):
    """The controlled part: it senses, and moves by its inputs."""

    name: str = "plant"
    steps: int
    """Control steps after which every trial ends."""
    senses: tuple[str, ...] = ()
    """Sources of the interface that `sense` returns."""
    shows: tuple[str, ...] = ()
    """Truths that `sense` returns as well, for modules that declare them."""

    @abstractmethod
    def start(self, batch: Batch) -> State:
        """Return the state at the start of a batch's trials."""

    @abstractmethod
    def sense(self, state: State) -> Outputs:
        """Return the present value of each of `senses` and `shows`."""

    @abstractmethod
    def advance(self, state: State, inputs: Inputs) -> State:
        """Return the state one control step later. The loop does not use the old state again."""

    @abstractmethod
    def progress(self, state: State) -> Progress:
        """Return the state of the trials."""

    @abstractmethod
    def conditions(self, state: State) -> tuple[Sequence[str], Sequence[str]]:
        """Return hashes of each scene's initial state and of its disturbances, `[B]` each."""

    def over(self, state: State, step: int) -> bool | None:
        """Return whether all trials have ended; `None`: the loop reads `progress` at every step.

        Override it where that read waits for a device, and wait at some steps only.
        """
        del state, step
        return None

    def position(self, state: State) -> Array | None:
        """Return the positions of the scenes' vehicles, `[B, 3]`, m; `None`: nothing to draw."""
        del state
        return None


@dataclass(frozen=True)
class Graph:
    """A plant and its modules in the order in which a step executes them."""

    plant: Plant
    modules: tuple[Module, ...]
    bindings: Mapping[str, str] = field(default_factory=dict[str, str])
    """Channel to the source that feeds it."""

    @property
    def parts(self) -> tuple[Part, ...]:
        """All readers: the modules, and the plant last."""
        return (*self.modules, self.plant)


def label_of(part: Part) -> str:
    """Return the name of a part in messages."""
    return "the plant" if isinstance(part, Plant) else f"module '{part.name}'"


def readers(parts: Iterable[Part]) -> frozenset[str]:
    """Return the names `module.place` under which the interface lists the parts' ports."""
    return frozenset(part.reader(port) for part in parts for port in part.ports)
