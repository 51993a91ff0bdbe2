"""The parts of a closed loop: modules that read and write, and the plant under them."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple, TypeAlias

from faultpath.core.arrays import Array
from faultpath.loop.reading import IllegalRead, UndeclaredReader

Memory: TypeAlias = Any
"""Values that a module carries from step to step; opaque to everybody else."""

State: TypeAlias = Any
"""Values that a plant carries from step to step; opaque to everybody else."""

Outputs: TypeAlias = Mapping[str, Any]
"""By source: an array `[B, ...]`, or a `faultpath.loop.Query` that is asked within the step."""


class Port(NamedTuple):
    """A channel and the place in the module where it enters: one tap.

    The same channel at two places is two ports, for a fault may reach one of them alone. A module
    that runs others inside it names their places in full, `observer.flux`: they are readers of
    their own.
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
        at_read: Mapping[Port, Callable[[], Any]] | None = None,
        label: str = "",
    ) -> None:
        super().__init__(delivered)
        self.module = module
        self._label = label or f"module '{module}'"
        self.step = step
        """Control step, from 0."""
        self.running = running
        """Which scenes still run, bool `[B]`, for modules that save work; `None`: all."""
        self.at_read = at_read or {}
        """Deliveries that happen only when a port is looked at."""
        self._truths = truths

    def __missing__(self, port: tuple[str, str]) -> Any:
        channel, place = port
        if deliver := self.at_read.get(Port(channel, place)):
            self[port] = got = deliver()
            return got
        raise UndeclaredReader(
            f"{self._label} looked for channel '{channel}' at '{place}', a port that it "
            f"does not declare: add Port('{channel}', '{place}') to its reads"
        )

    def truth(self, name: str) -> Any:
        """Return what the plant shows of its own state; `IllegalRead` for an undeclared one."""
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
    """Name under which the interface lists its readers, `name.place`. Parts may share it: a fault
    at that module then reaches them all."""
    reads: frozenset[Port] = frozenset()
    """Ports that get what their source holds at this step."""
    reads_past: frozenset[Port] = frozenset()
    """Ports that get what their source held one step before: this is what closes a cycle. At the
    first step that is what the source's module gives as `before`."""
    at_read: frozenset[Port] = frozenset()
    """Ports that get their reading only in steps in which it is looked at; the delivery
    log then counts what was read and not what was handed over."""

    writes: tuple[str, ...] = ()
    """Sources of the interface that it produces at every step; a plant senses its sources."""

    def __str__(self) -> str:
        return self.name

    @property
    def ports(self) -> frozenset[Port]:
        """All ports that it reads."""
        return self.reads | self.reads_past

    def reader(self, port: Port) -> str:
        """Return the name `module.place` under which the interface lists a port."""
        return port.place if "." in port.place else f"{self.name}.{port.place}"


class Module(Part):
    """A part of the controller: readings and memory in, sources and memory out.

    It keeps nothing of its own from step to step, does not write into what it reads, and gives
    each scene a result that does not depend on the other scenes of the batch. Random numbers come
    from `faultpath.core.streams`, by scene, seed and step.
    """

    truths: tuple[str, ...] = ()
    """Parts of the plant's own state that it takes past all taps. Only an override of an estimator
    does so, and tracing names it."""

    def begin(self, batch: Batch) -> Memory:
        """Return the memory before the first step."""
        del batch

    @abstractmethod
    def step(self, inputs: Inputs, memory: Memory) -> tuple[Outputs, Memory]:
        """Return what each of `writes` holds at this step, and the memory for the next one."""

    def before(self, batch: Batch) -> Outputs:
        """Return what its sources held before the first step, for ports that read the past."""
        del batch
        return {}

    def noise_hashes(self, batch: Batch) -> Sequence[str] | None:
        """Return a hash of what it draws in each scene, `None` for a module that draws nothing.

        Two trials count as a pair only where these agree.
        """
        del batch
        return None


@dataclass(frozen=True)
class Progress:
    """State of each scene's trial, `[B]` each; one that runs no longer stays as it ended."""

    running: Array
    succeeded: Array
    crashed: Array
    """A trial that neither succeeded nor crashed has timed out."""
    time_s: Array
    """Time at which it ended, or of now."""
    metrics: Mapping[str, Array] = field(default_factory=dict[str, Array])
    """Further measurements by name, `[B]` each."""


class Plant(Part):
    """The part that the loop closes over: it senses, and what it reads at its ports moves it."""

    name: str = "plant"
    steps: int
    """Control steps after which every trial ends."""
    senses: tuple[str, ...] = ()
    """Sources of the interface that `sense` gives."""
    shows: tuple[str, ...] = ()
    """Truths that `sense` gives beside: only for modules that declare them."""

    @abstractmethod
    def start(self, batch: Batch) -> State:
        """Return the state at the start of a batch's trials."""

    @abstractmethod
    def sense(self, state: State) -> Outputs:
        """Return what each of `senses` and `shows` holds now."""

    @abstractmethod
    def advance(self, state: State, inputs: Inputs) -> State:
        """Return the state one control step later. The state given is not used again."""

    @abstractmethod
    def progress(self, state: State) -> Progress:
        """Return where the trials stand."""

    @abstractmethod
    def conditions(self, state: State) -> tuple[Sequence[str], Sequence[str]]:
        """Return hashes of each scene's initial state and of its disturbances, `[B]` each."""

    def over(self, state: State, step: int) -> bool:
        """Return whether no trial runs any more; where that waits for a device, not every step."""
        del step
        return not bool(self.progress(state).running.any())

    def position(self, state: State) -> Array | None:
        """Return where the scenes' vehicles are, `[B, 3]`, metres; `None`: nothing to draw."""
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
        """All that read: the modules, and the plant last."""
        return (*self.modules, self.plant)


def label_of(part: Part) -> str:
    """Return what messages call a part."""
    return "the plant" if isinstance(part, Plant) else f"module '{part.name}'"


def readers(parts: Iterable[Part]) -> frozenset[str]:
    """Return the names `module.place` under which the interface lists the parts' ports."""
    return frozenset(part.reader(port) for part in parts for port in part.ports)
