"""Where a module reads, and what it gets there at a step."""

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from faultpath.core.arrays import Array
from faultpath.loop.taps import IllegalRead, UndeclaredReader


class Port(NamedTuple):
    """A channel and the place in the module where it enters: one tap.

    The same channel at two places is two ports, for a fault may reach one of them alone.
    """

    channel: str
    place: str


class Inputs(Mapping[Port, Any]):
    """What the taps delivered to one module at one step: an entry for each of its ports.

    A signal is an array `[B, ...]`, one row a scene; a query is a function of a request. A port
    that the module did not declare has no entry to find.
    """

    def __init__(
        self,
        module: str,
        step: int,
        delivered: Mapping[Port, Any],
        truths: Mapping[str, Any],
        running: Array = None,
    ) -> None:
        self.module = module
        self.step = step
        """Control step, from 0."""
        self.running = running
        """Which scenes still run, bool `[B]`, for modules that save work; `None`: all."""
        self._delivered = delivered
        self._truths = truths

    def __getitem__(self, port: tuple[str, str]) -> Any:
        """Return what came at a port; raises `UndeclaredReader` for one that is not declared."""
        found = Port(*port)
        try:
            return self._delivered[found]
        except KeyError:
            raise UndeclaredReader(
                f"module '{self.module}' looked for channel '{found.channel}' at "
                f"'{found.place}', a port that it does not declare: add "
                f"Port('{found.channel}', '{found.place}') to its reads"
            ) from None

    def __contains__(self, port: object) -> bool:
        """Return whether the port is declared."""
        return port in self._delivered

    def get(self, port: Port, default: Any = None) -> Any:
        """Return what came at a port, `default` for one that is not declared."""
        return self[port] if port in self._delivered else default

    def __iter__(self) -> Iterator[Port]:
        """Iterate over the ports."""
        return iter(self._delivered)

    def __len__(self) -> int:
        """Return the number of ports."""
        return len(self._delivered)

    def truth(self, name: str) -> Any:
        """Return what the plant shows of its own state; `IllegalRead` for an undeclared one."""
        if name not in self._truths:
            raise IllegalRead(
                f"module '{self.module}' looked for the plant's truth '{name}', which it does not "
                "declare: add it to its truths"
            )
        return self._truths[name]
