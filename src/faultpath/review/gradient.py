"""Whether the plant's own tensors move an output of a module by a path that no tap sees.

Autograd is asked. Every reading is cut from its history where a tap delivers it, so an output that
still has a gradient with respect to a tensor of the plant's state got it past the taps: a
normaliser that captured the true mass, say. A copy that a module or its memory has held since the
start has no history; it is told by its numbers, which are those of the plant.

What leaves torch is not seen: numbers in Python or NumPy, what is computed without gradients or in
a compiled kernel, and a copy that was computed with before it was kept. Modules in which the
gradient stops are named, so that silence is not taken for proof.
"""

import sys
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from functools import wraps
from types import FunctionType, MethodType, ModuleType
from typing import Any, cast

from typing_extensions import override

from faultpath.blame import described
from faultpath.execution.attempt import taps_of
from faultpath.loop import Batch, Graph, Module
from faultpath.results import Result
from faultpath.taps import Query, Reading, Taps
from faultpath.taps.tap import Tap
from faultpath.trials import Arm, LoopSystem

_DEEP = 8


class Gradient(Result):
    """What autograd tells of a traced variant."""

    seen: tuple[str, ...] = ()
    """Modules whose outputs carry a gradient of what the taps deliver."""
    unseen: tuple[str, ...] = ()
    """Modules in which it stops: of these nothing is known."""
    found: tuple[str, ...] = ()
    failed: str = ""
    """Why the variant could not be run with gradients to its end."""

    def words(self) -> tuple[str, ...]:
        """Say how far it could see."""
        if self.failed:
            return (f"Gradients could not be followed, and show no path past taps: {self.failed}",)
        seen = f"Gradients were followed through {', '.join(self.seen)}." if self.seen else ""
        unseen = ", ".join(self.unseen)
        stops = f"The gradient stops in {unseen}: a path past its taps would not be seen."
        return tuple(filter(None, (seen, stops if unseen else "")))


def gradient(
    system: LoopSystem, variant: str, scenes: Sequence[str], steps: int, seed: int
) -> Gradient | None:
    """Run a variant for a few steps with gradients; `None` where nothing of it is torch."""
    torch: Any = sys.modules.get("torch")
    if torch is None:
        return None
    loop = system.loop(variant, seed)
    watch = _Watch(torch, loop.graph)
    taps = taps_of(system, Arm(variant=variant, seed=seed), scenes, _Cutting, torch=torch)
    batch = Batch(tuple(scenes), seed, system.control_dt_s)
    failed = ""
    try:
        with torch.inference_mode(False), torch.enable_grad():
            for instant in loop.execute(batch, taps):
                if instant.step >= steps:
                    break
    except Exception as error:  # whatever a system does that was not made for gradients
        failed = described(error)
    finally:
        watch.undo()
    if not (watch.torches or failed):
        return None
    seen = tuple(name for name, carries in watch.carries.items() if carries)
    unseen = tuple(name for name, carries in watch.carries.items() if not carries)
    return Gradient(seen=seen, unseen=unseen, found=tuple(watch.found), failed=failed)


class _Cutting(Taps):
    """Taps that deliver tensors without their history, ready to be differentiated by."""

    def __init__(self, *given: Any, torch: Any, **named: Any) -> None:
        super().__init__(*given, **named)
        self._torch = torch

    def deliver(self, channel: str, consumer: str, reading: Reading, step: int) -> Any:
        """Deliver as `Taps` does, a tensor as one that has no history."""
        return self._cut(super().deliver(channel, consumer, reading, step))

    @override
    def _answer(self, tap: Tap, query: Query, step: int, request: Any) -> Any:
        answer = super()._answer(tap, query, step, request)
        return query.changed(answer, self._cut(query.value(answer)))

    def _cut(self, value: Any) -> Any:
        if not isinstance(value, self._torch.Tensor):
            return value
        apart = value.detach().clone()
        return apart.requires_grad_() if apart.is_floating_point() else apart


class _Watch:
    """Marks tensors of the plant, and looks at what each module's outputs depend on."""

    def __init__(self, torch: Any, graph: Graph) -> None:
        self._torch = torch
        self._marked: dict[int, tuple[str, Any]] = {}
        self._plants: list[tuple[str, Any]] = []
        self._patched: list[tuple[Any, str]] = []
        self.carries: dict[str, bool] = {}
        self.torches = False
        """Whether any tensor was met."""
        self.found: dict[str, None] = {}
        self._after(graph.plant, "start", self._mark_state)
        for module in graph.modules:
            if not module.truths:  # what it takes past the taps it declares
                self._after(module, "begin", lambda memory, m=module: self._mark_held(m, memory))
                self._after(module, "step", lambda done, m=module: self._look(m, done))

    def _after(self, part: Any, method: str, then: Callable[[Any], Any]) -> None:
        does = getattr(part, method)

        @wraps(does)
        def watched(*given: Any) -> Any:
            return then(does(*given))

        setattr(part, method, watched)
        self._patched.append((part, method))

    def undo(self) -> None:
        """Leave parts and tensors as they were."""
        for part, method in self._patched:
            delattr(part, method)
        for _, tensor in self._marked.values():
            tensor.requires_grad_(False)

    def _mark_state(self, state: Any) -> Any:
        for name, tensor in _tensors(self._torch, state):
            self._plants.append((name, tensor.detach().clone()))
            self._mark(f"the plant's '{name}'", tensor)
        return state

    def _mark_held(self, module: Module, memory: Any) -> Any:
        held = [*_tensors(self._torch, vars(module)), *_tensors(self._torch, {"memory": memory})]
        for name, tensor in held:
            if twin := next((n for n, t in self._plants if _alike(t, tensor)), None):
                self._mark(f"its own '{name}', which holds the plant's '{twin}'", tensor)
        return memory

    def _mark(self, name: str, tensor: Any) -> None:
        self.torches = True
        if tensor.is_leaf and not tensor.requires_grad and not tensor.is_inference():
            tensor.requires_grad_()
            self._marked[id(tensor)] = name, tensor

    def _look(self, module: Module, done: tuple[Mapping[str, Any], Any]) -> Any:
        outputs, memory = done
        return {name: self._seen(module, name, value) for name, value in outputs.items()}, memory

    def _seen(self, module: Module, source: str, value: Any) -> Any:
        if isinstance(value, Query):

            def answer(request: Any) -> Any:
                made = value.answer(request)
                self._differentiate(module, source, value.value(made))
                return made

            return Query(answer, value.value, value.changed)
        self._differentiate(module, source, value)
        return value

    def _differentiate(self, module: Module, source: str, value: Any) -> None:
        tensor = isinstance(value, self._torch.Tensor)
        self.torches = self.torches or tensor
        carries = tensor and bool(value.requires_grad)
        self.carries[module.name] = self.carries.get(module.name, False) or carries
        if not carries or not self._marked:
            return
        names, leaves = zip(*self._marked.values(), strict=True)
        weights = self._torch.linspace(0.5, 1.5, value.numel(), dtype=value.dtype)
        slopes = self._torch.autograd.grad(
            value,
            leaves,
            weights.reshape(value.shape).to(value.device),
            retain_graph=True,
            allow_unused=True,
        )
        for name, slope in zip(names, slopes, strict=True):
            if slope is not None and bool((slope != 0).any()):
                said = (
                    f"Source '{source}' of module '{module.name}' moves with {name} by a path that "
                    "no tap sees; read it at a port, or declare it among the module's truths."
                )
                self.found[said] = None


def _alike(plants: Any, held: Any) -> bool:
    if plants.numel() != held.numel() or plants.dtype != held.dtype:
        return False
    same = bool((plants.reshape(-1) == held.detach().reshape(-1)).all())
    return same and bool(((plants != 0) & (plants.abs() != 1)).any())


def _tensors(
    torch: Any, thing: Any, name: str = "", deep: int = 0, met: set[int] | None = None
) -> Iterator[tuple[str, Any]]:
    met = set() if met is None else met
    if id(thing) in met or deep > _DEEP or isinstance(thing, (str, bytes, int, float, type)):
        return
    met.add(id(thing))
    if isinstance(thing, torch.Tensor):
        if thing.is_floating_point() and not isinstance(thing, torch.nn.Parameter):
            yield name, thing
        return
    for key, part in _parts(thing):
        hidden = key in ("_buffers", "_modules")  # of a torch module
        yield from _tensors(
            torch, part, name if hidden else f"{name}.{key}".lstrip("."), deep + 1, met
        )


def _parts(thing: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(thing, Mapping):
        mapping = cast("Mapping[Any, Any]", thing)
        yield from ((str(key), part) for key, part in mapping.items())
    elif isinstance(thing, (list, tuple, set, frozenset)):
        parts = cast("Collection[Any]", thing)
        named: Iterable[Any] = getattr(parts, "_fields", None) or range(len(parts))
        yield from zip(map(str, named), parts, strict=True)
    elif isinstance(thing, MethodType):
        yield "self", thing.__self__
    elif isinstance(thing, FunctionType):
        names, cells = thing.__code__.co_freevars, thing.__closure__ or ()
        yield from ((name, cell.cell_contents) for name, cell in zip(names, cells, strict=True))
    elif not isinstance(thing, ModuleType) and hasattr(thing, "__dict__"):
        yield from cast("dict[str, Any]", vars(thing)).items()
