"""Taps on existing objects: their attributes, keys or arguments are delivered at each read."""

from collections.abc import Callable, Generator, Iterator, Mapping, MutableMapping
from contextlib import contextmanager
from contextvars import ContextVar
from functools import partial, wraps
from inspect import isroutine, signature
from types import new_class
from typing import Any, TypeVar, cast

from faultpath.core.error_source import described
from faultpath.core.errors import SystemMistake
from faultpath.core.text import listed, unknown
from faultpath.loop import Inputs, Port
from faultpath.system.sharing import Walk

T = TypeVar("T")

_STAND_INS: ContextVar[list["Reads"] | None] = ContextVar("_STAND_INS", default=None)
"""Collects the stand-ins of the objects under construction."""


class Reads:
    """The reads of one stand-in, and the inputs of the present step."""

    def __init__(self, at: str, what: Any, channels: Mapping[str, str]) -> None:
        self.at, self.what = at, what
        self.kind = _callable_name(what) if _is_callable(what) else type(what).__name__
        # Readers are in small letters, which attributes need not be.
        self.ports = {n: Port(channel, f"{at}.{n.lower()}") for n, channel in channels.items()}
        self.own: dict[str, Any] = {}
        """Values that its reader wrote itself. It reads these from then on, as it would from an
        object of its own; other readers still get the delivered values."""
        self.inputs: Inputs | None = None
        self.row = 0

    def read(self, name: str) -> Any:
        """Return the delivered value of an attribute, key or argument, one scene's row."""
        if name in self.own:
            return self.own[name]
        if self.inputs is None:
            raise SystemMistake(
                f"'{self.at}' read '{name}' of {self.kind} while it was made, or outside of a "
                "step, where nothing is delivered and no fault would reach what it keeps: tap the "
                f"object that keeps the copy, or let the function that makes it take {name} as an "
                "argument"
            )
        return self.inputs.row(self.ports[name], self.row)


_MUTABLE: Any = MutableMapping


class _Keys(dict[Any, Any]):
    """A stand-in for a mapping. Its own `__iter__` keeps `dict(...)` from copying past the taps,
    and the methods of `MutableMapping` go through those below, which those of `dict` do not."""

    reads: Reads

    def __getitem__(self, key: Any) -> Any:
        value = super().__getitem__(key)
        return self.reads.read(key) if key in self.reads.ports else value

    def __setitem__(self, key: Any, value: Any) -> None:
        if key in self.reads.ports:
            self.reads.own[key] = value
        super().__setitem__(key, value)

    def __iter__(self) -> Iterator[Any]:
        return iter(list(super().keys()))

    def __ior__(self, other: Any) -> Any:
        self.update(other)
        return self

    get, items, values = _MUTABLE.get, _MUTABLE.items, _MUTABLE.values
    pop, popitem = _MUTABLE.pop, _MUTABLE.popitem
    setdefault, update = _MUTABLE.setdefault, _MUTABLE.update


def tapped(what: T, *names: str, at: str, **channels: str) -> T:
    """Return a stand-in that gets some attributes, keys or arguments delivered at each read.

    Each of them is a channel, by default of the same name, and its reader is `at.name` in small
    letters. Everything else is shared with the object: the stand-in is of a class derived from the
    object's, and has the object's own attributes. Once its reader writes into a tapped attribute,
    the reader gets its own value, and no fault reaches it there any more.

    A function, a method or a class is tapped at its call: delivered values replace these arguments,
    whether the caller passes them or leaves them out. Put the stand-in where the caller looks:
    `part.filter.update = tapped(part.filter.update, "speed", at="filter")`.

    Make stand-ins in the function that `writes(..., of=make)` calls for each scene. An object whose
    own methods are kept elsewhere can be read past its taps; `writes` refuses it and says where.

    Args:
        what: An object with attributes that Python keeps, a dict, or a callable.
        names: Attributes, keys or arguments that are channels of the same name.
        at: Module that reads them.
        channels: Attribute, key or argument to channel, for other names.

    Raises:
        SystemMistake: There is no such attribute, key or argument, an attribute is a method, or the
            object keeps its attributes where no stand-in is possible: in slots, a tuple or compiled
            code. At a read: nothing is delivered yet, because the reader is still being made, or
            compiled code does not take the arguments by name.
    """
    kind = cast("type[Any]", type(what))
    if not names and not channels:
        raise SystemMistake(
            f"tapped {kind.__name__}: names nothing to tap: give an attribute, key or argument"
        )
    reads = Reads(at, what, {name: name for name in names} | channels)
    if _is_callable(what):
        return _collect(reads, _tapped_call(what, reads))
    keyed = isinstance(what, dict)
    known = list(cast("dict[Any, Any]", what)) if keyed else dir(what)
    for name in reads.ports:
        if name not in known:
            word = "key" if keyed else "attribute"
            raise SystemMistake(f"tapped {kind.__name__}: {unknown(word, name, map(str, known))}")
        if not keyed and isroutine(getattr(kind, name, None)):
            raise SystemMistake(
                f"tapped {kind.__name__}: '{name}' is a method: tap what it is called with, "
                f"x.{name} = tapped(x.{name}, 'its argument', at='{at}')"
            )
    if keyed:
        stand_in: Any = type(kind.__name__, (_Keys,), {"reads": reads})()
        cast("Any", dict).update(stand_in, what)
    else:
        properties: dict[str, Any] = {name: _delivered(reads, name) for name in reads.ports}
        try:
            derived = new_class(
                kind.__name__, (kind,), exec_body=lambda body: body.update(properties)
            )
            stand_in = cast("Any", object.__new__(derived))
            object.__setattr__(stand_in, "__dict__", vars(what))
        except TypeError as error:
            raise SystemMistake(
                f"tapped {kind.__name__}: it keeps its attributes in slots, a tuple or compiled "
                "code, where no stand-in can be: tap the object that holds it, or hand the value "
                "over as an argument of the module"
            ) from error
    return _collect(reads, stand_in)


def _collect(reads: Reads, stand_in: Any) -> Any:
    if (collected := _STAND_INS.get()) is not None:
        collected.append(reads)
    return stand_in


def _is_callable(what: Any) -> bool:
    return isroutine(what) or isinstance(what, type | partial)


def _callable_name(what: Any) -> str:
    """Return the name of a function, method or class in messages."""
    return getattr(what.func if isinstance(what, partial) else what, "__qualname__", "a function")


def _tapped_call(what: Any, reads: Reads) -> Any:
    """Return a function that calls `what` with delivered arguments."""
    positions = _positional(what, reads)

    @wraps(what, updated=())
    def stand_in(*positional: Any, **named: Any) -> Any:
        values = {name: reads.read(name) for name in reads.ports}
        arguments = list(positional)
        for index, name in enumerate(positions or ()):
            if name in values and index < len(arguments):
                arguments[index] = values.pop(name)
        try:
            return what(*arguments, **named | values)
        except TypeError as error:
            if positions is not None:
                raise
            raise SystemMistake(
                f"'{reads.at}' calls {reads.kind}, which is compiled, with {listed(values)} by "
                f"name, and it refuses ({described(error)}): tap arguments under the names that it "
                "has for them, and leave them out where it is called"
            ) from error

    return stand_in


def _positional(what: Any, reads: Reads) -> list[str] | None:
    """Return the arguments that may be passed by position; `None` if they are unknown.

    Raises `SystemMistake` for a tapped argument that does not exist.
    """
    try:
        parameters = tuple(signature(what).parameters.values())
    except ValueError:  # compiled code may have no signature
        return None
    known = [p.name for p in parameters if p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)]
    takes_any = any(p.kind is p.VAR_KEYWORD for p in parameters)
    for name in reads.ports:
        if name not in known and not takes_any:
            raise SystemMistake(f"tapped {reads.kind}: {unknown('argument', name, known)}")
    return [p.name for p in parameters if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]


def _delivered(reads: Reads, name: str) -> property:
    def write(_: Any, value: Any) -> None:
        reads.own[name] = value

    return property(lambda _: reads.read(name), write)


class SceneObjects:
    """The objects of one scene."""

    def __init__(self, make: Callable[[], Any]) -> None:
        collected: list[Reads] = []
        token = _STAND_INS.set(collected)
        try:
            self.objects = make()
        finally:
            _STAND_INS.reset(token)
        self.reads = tuple(collected)
        self.last: Any = None
        """Latest value of the module in this scene."""

    @property
    def ports(self) -> frozenset[Port]:
        """Ports at which its stand-ins read."""
        return frozenset(port for reads in self.reads for port in reads.ports.values())

    def check(self) -> None:
        """Raise `SystemMistake` where a tapped object's contents refer back to it."""
        for reads in self.reads:
            inner = Walk(reads.kind, getattr(reads.what, "__dict__", {})).objects.get(
                id(reads.what)
            )
            if inner is not None:
                raise SystemMistake(
                    f"'{reads.at}' reads past its taps: {inner.place} is the {reads.kind} that is "
                    "not tapped; after tapping, put the stand-in or its method there"
                )

    @contextmanager
    def reading(self, inputs: Inputs, row: int) -> Generator[Any]:
        """Let the stand-ins read the inputs of a step, and yield the objects."""
        for reads in self.reads:
            reads.inputs, reads.row = inputs, row
        try:
            yield self.objects
        finally:
            for reads in self.reads:
                reads.inputs = None
