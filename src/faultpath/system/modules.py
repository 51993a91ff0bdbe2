"""Functions as modules, which read their arguments."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from inspect import Parameter, signature
from typing import Any, cast

import numpy as np
from typing_extensions import override

from faultpath.core.arrays import copy, is_array, namespace
from faultpath.core.error_source import described, location, location_of, mistake_in
from faultpath.core.errors import SystemMistake
from faultpath.core.text import unknown
from faultpath.loop import Batch, Inputs, Memory, Module, Outputs, Port
from faultpath.system.tapping import SceneObjects

MEMORY = "memory"
"""Name of the argument that is not a channel."""


def writes(
    source: str,
    *,
    past: str | Sequence[str] = (),
    before: Any = None,
    of: Callable[..., Any] | None = None,
    name: str = "",
) -> Callable[[Callable[..., Any]], "FunctionModule"]:
    """Make a function a module that writes `source`: `@writes("push")` above its `def`.

    Each argument is a channel, read at a place of the same name, with one row a scene, `[B, ...]`.
    The function returns the value of `source`. With an argument `memory`, which is `None` at the
    first step, it returns `(value, memory)`.

    With `of` the module has objects that keep their own state, a set for each scene. The function
    is then called one scene at a time, while the scene runs: with the scene's objects first, and
    rows without the batch axis. Attributes of these objects that are `tapped` are ports too.

    Objects are made at a scene's first step. Required arguments of the function that makes them are
    channels as well; it gets their first readings.

    Args:
        source: Source that it writes.
        past: Arguments that get the value of the step before.
        before: Value of `source` before the first step, of one scene, for readers of its past.
        of: Makes the objects of one scene, from readings if it has arguments.
        name: Name of the module; default the function's. An audit faults modules of one name
            together, so a function that replaces another in a variant needs its name.

    Raises:
        SystemMistake: The function has arguments without names, or not the named one; `of` makes
            objects from readings and taps some of them.
    """
    past = (past,) if isinstance(past, str) else tuple(past)
    return lambda function: FunctionModule(
        function, source, past, before, {}, of, name or getattr(function, "__name__", "")
    )


class FunctionModule(Module):
    """A module made of a function; see `writes`."""

    def __init__(
        self,
        function: Callable[..., Any],
        source: str,
        past: Sequence[str],
        before: Any,
        values: dict[str, Any],
        of: Callable[..., Any] | None,
        name: str,
    ) -> None:
        self.name, self.writes = name, (source,)
        self._function, self._past, self._before, self._values = function, past, before, values
        self._of = of
        parameters = dict(signature(function).parameters)
        if of is not None:  # the first argument gets the objects
            parameters.pop(next(iter(parameters), ""), None)
            self._called_with, made_of = tuple(parameters), _required_arguments(of)
            self._made_of = tuple(made_of)
            parameters |= made_of
            if made_of.keys() <= values.keys():
                sample = self._make(values)
                sample.check()
                self.at_read = sample.ports
            if MEMORY in parameters:
                raise SystemMistake(
                    f"module '{self.name}' has objects and a memory: let the objects keep it"
                )
        if odd := [
            parameter.name
            for parameter in parameters.values()
            if parameter.kind not in (Parameter.POSITIONAL_OR_KEYWORD, Parameter.KEYWORD_ONLY)
        ]:
            raise SystemMistake(
                f"module '{self.name}': its argument '{odd[0]}' has no name to hand it over by: "
                "give each channel an argument of its own"
            )
        for name in (*past, *values):
            if name not in parameters:
                raise SystemMistake(
                    f"module '{self.name}': {unknown('argument', name, list(parameters))}"
                )
        self._remembers = MEMORY in parameters
        read = {Port(name, name) for name in parameters if name not in (MEMORY, *values)}
        self.reads_past = frozenset(port for port in read if port.channel in past)
        self.reads = frozenset(read - self.reads_past) | self.at_read
        self._handed_over = tuple(sorted(read))

    def _make(self, row: Mapping[str, Any]) -> SceneObjects:
        """Return the objects of a scene, made from its readings and values."""
        of = cast("Callable[..., Any]", self._of)
        return SceneObjects(partial(of, **{name: row[name] for name in self._made_of}))

    def given(self, **values: Any) -> "FunctionModule":
        """Return the module with values for some arguments, which it then no longer reads.

        A value is passed as it is: one number for all scenes, where a reading `[B]` has one each.
        """
        values = self._values | values
        source = self.writes[0]
        return FunctionModule(
            self._function, source, self._past, self._before, values, self._of, self.name
        )

    def __str__(self) -> str:
        """Return its name and the numbers given to it."""
        words = [f"{name} {value:g}" for name, value in self._numbers.items()]
        return f"{self.name} ({', '.join(words)})" if words else self.name

    @property
    def location(self) -> str:
        """File and line of a user's function; empty for any other."""
        return location_of(self._function)

    @property
    def defaults(self) -> dict[str, Any]:
        """Defaults of arguments, which are never used: each argument is a source or given."""
        parameters = signature(self._function).parameters
        named = {name: parameter.default for name, parameter in parameters.items()}
        return {k: v for k, v in named.items() if v is not Parameter.empty}

    @property
    def _numbers(self) -> dict[str, int | float]:
        return {n: v for n, v in self._values.items() if isinstance(v, int | float)}

    def _returned_nothing(self) -> SystemMistake:
        sentence = f"module '{self.name}' returned None: is a `return` missing?"
        return mistake_in(self._function, sentence)

    def _refused(self, numbers: Iterable[str], error: Exception) -> SystemMistake:
        """Return the message for an error at the first step of a module with given numbers."""
        mistake = SystemMistake(
            f"module '{self.name}' fails ({described(error)}) with one number for every scene as "
            f"its {' and '.join(numbers)}, where a reading has one value a scene: let it take "
            "both, or correct it there"
        )
        mistake.location = location(error)
        return mistake

    @override
    def before(self, batch: Batch) -> Outputs:
        if self._before is None:
            return {}
        row = np.asarray(self._before, np.float64)
        return {self.writes[0]: np.tile(row, (len(batch.scenes), *[1] * row.ndim))}

    @override
    def begin(self, batch: Batch) -> Memory:
        return [None] * len(batch.scenes) if self._of else None

    def _step_scene(self, inputs: Inputs, i: int, scene: SceneObjects | None) -> SceneObjects:
        """Make a step with the objects of one scene, which are made at the first."""
        rows = {port.channel: inputs[port][i] for port in self._handed_over} | self._values
        if scene is None:
            scene = self._make(rows)
            if scene.ports - self.at_read:
                raise SystemMistake(
                    f"module '{self.name}' taps objects that are made of readings: let the "
                    "function that makes them take no readings, or tap none of them"
                )
        with scene.reading(inputs, i) as objects:
            arguments = {name: rows[name] for name in self._called_with}
            value = self._function(objects, **arguments)
            if value is None:
                raise self._returned_nothing()
            # `max(0, push)` is a whole number in some scenes, and real where others stand beside.
            scene.last = np.array(float(value) if type(value) is int else value)
        return scene

    @override
    def step(self, inputs: Inputs, memory: Memory) -> tuple[Outputs, Memory]:
        if self._of:
            memory = [
                self._step_scene(inputs, i, scene)
                if inputs.running is None or inputs.running[i]
                else scene
                for i, scene in enumerate(cast("list[SceneObjects]", memory))
            ]
            return {self.writes[0]: np.stack([scene.last for scene in memory])}, memory
        rows = {port.channel: inputs[port] for port in self._handed_over}
        more = {MEMORY: memory} if self._remembers else {}
        try:
            pair: Any = self._function(**rows, **self._values, **more)
        except (TypeError, ValueError, AttributeError, LookupError) as error:
            writes_input = "read-only" in str(error)
            if inputs.step == 0 and not writes_input and (numbers := self._numbers):
                raise self._refused(numbers, error) from error
            raise
        if pair is None:
            raise self._returned_nothing()
        if not self._remembers:
            if not rows and isinstance(pair, int | float) and inputs.running is not None:
                pair = np.full(
                    len(inputs.running), pair, bool if isinstance(pair, bool) else np.float64
                )
            return {self.writes[0]: pair}, None
        if not isinstance(pair, tuple) or len(cast("tuple[Any, ...]", pair)) != 2:
            raise mistake_in(
                self._function,
                f"module '{self.name}' has a memory and returned no pair: return (value, memory)",
            )
        value, memory = cast("tuple[Any, Any]", pair)
        # A memory that the function goes on writing into may be the value itself.
        return {self.writes[0]: copy(value) if is_array(value) else value}, memory


def _required_arguments(make: Callable[..., Any]) -> dict[str, Parameter]:
    try:
        parameters = signature(make).parameters
    except ValueError:  # such as that of `dict`
        return {}
    several = (Parameter.VAR_POSITIONAL, Parameter.VAR_KEYWORD)
    return {
        name: parameter
        for name, parameter in parameters.items()
        if parameter.default is Parameter.empty and parameter.kind not in several
    }


def row_wise(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function, such as a torch module, that takes the rows of a batch one at a time.

    A matrix product rounds differently for another number of rows; row by row each scene gets the
    same bits whatever the other scenes. Arrays, also the returned ones, are `[B, ...]`; all other
    arguments are passed on unchanged. Raises `SystemMistake` for arrays of different B, or none.
    """

    def each(*values: Any, **named: Any) -> Any:
        counts = {len(v) for v in (*values, *named.values()) if is_array(v) and v.ndim}
        if len(counts) != 1:
            counts_shown = ", ".join(map(str, sorted(counts))) or "none"
            raise mistake_in(
                function,
                f"a function that is row_wise got arrays of different rows ({counts_shown}): give "
                "it arrays with one row a scene, and what is the same for all scenes beforehand",
            )

        def row(value: Any, i: int) -> Any:
            return value[i : i + 1] if is_array(value) and value.ndim else value

        single = [
            function(*(row(v, i) for v in values), **{n: row(v, i) for n, v in named.items()})
            for i in range(counts.pop())
        ]
        if isinstance(single[0], tuple):
            return tuple(namespace(parts[0]).concat(parts) for parts in zip(*single, strict=True))
        return namespace(single[0]).concat(single)

    return each
