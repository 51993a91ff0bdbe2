"""A system composed of an episode plant and modules; its interface follows from these."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from hashlib import sha256
from os import PathLike
from typing import Any

import numpy as np
from typing_extensions import override

from faultpath.core.errors import SystemMistake, UserError
from faultpath.core.text import unknown
from faultpath.interface import Interface
from faultpath.loop import Loop, Module, graph, interface_of
from faultpath.system.arguments import (
    channels_of,
    invalid_name,
    modules_of,
    seeds_of,
    shown,
    units_of,
    variants_of,
)
from faultpath.system.checks import UNNAMED
from faultpath.system.declared import Library, SceneRef
from faultpath.system.episodes import SCENE, EpisodePlant
from faultpath.system.loop_system import LoopSystem
from faultpath.system.modules import FunctionModule
from faultpath.system.shapes import first_shapes
from faultpath.system.system import BLOCK

SCENES: Mapping[str, Sequence[int]] = {
    "training": range(100),
    "selection": range(500, 600),
    "held-out": range(1000, 1100),
}
"""Default libraries of a system, and the seeds of their scenes."""
_MISSPELT = 0.85
"""Similarity from which a name counts as a misspelling of a source that has a unit of its own."""


@dataclass(frozen=True)
class Parts:
    """A variant: its modules in any order, or a function that returns them for a seed.

    The function is for trained modules; it gets `None` where only ports and shapes are needed.
    """

    description: str
    modules: Sequence[Module] | Callable[[int | None], Sequence[Module]]

    def of(self, seed: int | None) -> Sequence[Module]:
        """Return the modules of a treatment."""
        return self.modules(seed) if callable(self.modules) else self.modules


class ComposedSystem(LoopSystem):
    """A system of a plant and modules, whose interface follows from them.

    Readers follow from the modules' ports, shapes from the first step of each variant. Sources that
    the plant senses are measured, values that a scene's set-up returns are estimated (their
    channels have a fidelity gap), the plant's input and outputs of modules that read nothing are
    commanded, other outputs of modules are reconstructed.

    Args:
        name: Name of the system.
        plant: The controlled part.
        variants: The ways to wire it: `Parts`, or just their modules.
        units: Unit of each source, or the fields of a `faultpath.interface.Source` where there is
            more to say: unit, provenance, latency_s, rate_hz, uncertainty, correlation_group; and
            components, names of its numbers in charts.
        channels: Channels with several possible sources, and these; every other source is a channel
            of its own. A variant binds the first of them that one of its modules writes, else the
            first that the plant senses.
        scenes: Seeds of the scenes of each library. With a single library, commands run that one by
            default.
        data_files: Files and folders on whose contents a result depends; see `System.data_files`.

    Raises:
        SystemMistake: The parts do not fit together, or a source has no unit.
    """

    block_size = BLOCK
    """The plant moves one scene at a time, so larger blocks would gain little."""

    def __init__(
        self,
        name: str,
        plant: EpisodePlant,
        variants: Mapping[str, Parts | Sequence[Module]],
        units: Mapping[str, str | Mapping[str, Any]],
        channels: Mapping[str, Sequence[str]] | None = None,
        scenes: Mapping[str, Sequence[int]] = SCENES,
        data_files: Sequence[str | PathLike[str]] = (),
    ) -> None:
        self.name, self.control_dt_s = name, plant.dt_s
        self.metrics = {key: measure.metric for key, measure in plant.metrics.items()}
        self._plant, self._scenes = plant, seeds_of(scenes)
        self._data_files = tuple(data_files)
        self.components = dict[str, tuple[str, ...]]()
        units, alternatives = units_of(units), channels_of(channels or {})
        self._parts, self._bindings = dict[str, Parts](), dict[str, Mapping[str, str]]()
        for variant, parts in variants_of(variants).items():
            modules = modules_of(variant, parts.of(None) if isinstance(parts, Parts) else parts)
            listed = Parts(f"Modules: {', '.join(map(str, modules))}.", modules)
            self._parts[variant] = parts if isinstance(parts, Parts) else listed
            written = [name for module in modules for name in module.writes]
            self._bindings[variant] = {
                channel: next((n for n in (*written, *plant.senses) if n in sources), sources[0])
                for channel, sources in alternatives.items()
            }
        self._interface = self._declared(units, alternatives, plant.shapes)
        shapes: dict[str, tuple[int, ...]] = {}
        for variant in self._parts:
            bindings = self._bindings[variant]
            try:
                executable = graph(self._interface, plant, self.modules(variant, None), bindings)
            except SystemMistake as error:
                raise SystemMistake(f"variant '{variant}': {error}") from None
            shapes = first_shapes(Loop(self._interface, executable), plant.dt_s) | shapes
        self._interface = self._declared(units, alternatives, plant.shapes | shapes)

    @property
    @override
    def data_files(self) -> Sequence[str | PathLike[str]]:
        return self._data_files

    @property
    @override
    def interface(self) -> Interface:
        return self._interface

    @property
    @override
    def descriptions(self) -> Mapping[str, str]:
        return {variant: parts.description for variant, parts in self._parts.items()}

    @override
    def bindings(self, variant: str) -> Mapping[str, str]:
        return self._bindings[variant]

    @override
    def plant(self) -> EpisodePlant:
        return self._plant

    @override
    def modules(self, variant: str, seed: int | None) -> Sequence[Module]:
        return self._parts[variant].of(seed)

    @override
    def library(self, name: str) -> Library:
        if name in UNNAMED and len(self._scenes) == 1:
            (name,) = self._scenes
        if name not in self._scenes:
            raise UserError(f"{self.name}: {unknown('library', name, self._scenes)}")
        seeds = list(self._scenes[name])
        content = sha256(f"{self._plant.identity}{seeds}".encode()).hexdigest()[:16]
        return Library(name, tuple(SceneRef(f"{SCENE}{s}", s) for s in seeds), content)

    @override
    def fingerprint(self) -> str:
        return self._plant.identity

    @property
    @override
    def parts(self) -> Sequence[str]:
        return self._plant.code

    def _declared(
        self,
        units: Mapping[str, str | Mapping[str, Any]],
        alternatives: Mapping[str, Sequence[str]],
        shapes: Mapping[str, tuple[int, ...]],
    ) -> Interface:
        """Return the interface; a source of unknown shape counts as a number."""
        plant = self._plant
        modules = [module for parts in self._parts.values() for module in parts.of(None)]
        read = dict.fromkeys(
            port.channel for part in (*modules, plant) for port in sorted(part.ports)
        )
        feeds = {channel: alternatives.get(channel, (channel,)) for channel in read}
        if unused := alternatives.keys() - read:
            raise SystemMistake(
                f"system '{self.name}': no module reads what channels names: "
                f"{unknown('channel', min(unused), read)}"
            )
        # Until a first step shows a module's output, it has the shape of the source it replaces.
        for fed in feeds.values():
            if shaped := [name for name in fed if name in shapes]:
                shapes = dict.fromkeys(fed, shapes[shaped[0]]) | dict(shapes)
        written = [name for module in modules for name in module.writes]
        known = dict.fromkeys(plant.senses, "measured") | dict.fromkeys(plant.facts, "estimated")
        known |= dict.fromkeys(alternatives.get(plant.action, (plant.action,)), "commanded")
        computed = {name for module in modules if module.ports for name in module.writes}
        known |= dict.fromkeys(set(written) - computed, "commanded")
        for module in modules:
            if invalid := invalid_name(module):
                raise self._mistake(
                    module,
                    f"'{invalid}' cannot name a module, a place or a channel: use small letters, "
                    "digits and '_', a letter first; `name=` of @writes names a module",
                )
            for port in sorted(module.ports):
                available = list(dict.fromkeys((*plant.senses, *plant.facts, *written)))
                if not {*feeds[port.channel]} & {*available}:
                    raise self._unknown_source(module, port.channel, available)
            reads = {name for port in module.ports for name in feeds[port.channel]}
            if looped := (reads & {*module.writes}) - {*known}:
                raise self._mistake(
                    module,
                    f"it reads '{min(looped)}', which it writes itself: keep the value of the step "
                    "before in `memory`",
                )
        if plant.action in feeds and not {*feeds[plant.action]} & {*written}:
            raise SystemMistake(
                f"system '{self.name}': no module writes what the plant's action names: "
                f"{unknown('source', plant.action, dict.fromkeys(written))}"
            )
        names = (*plant.senses, *written, *(n for fed in feeds.values() for n in fed))
        self._check_units(units, names)
        sources = {
            name: {
                "name": name,
                "shape": shapes.get(name, ()),
                "provenance": known.get(name, "reconstructed"),
                **self._facts(name, units, shapes.get(name)),
            }
            for name in names
        }
        declared = [
            {
                "name": channel,
                "sources": list(fed),
                "gap": "fidelity" if sources[fed[0]]["provenance"] == "estimated" else "none",
            }
            for channel, fed in feeds.items()
        ]
        content = {"name": self.name, "sources": list(sources.values()), "channels": declared}
        try:
            return interface_of(content, (*modules, plant))
        except UserError as error:
            raise SystemMistake(f"system '{self.name}': {error}") from None

    def _mistake(self, module: Module, sentence: str) -> SystemMistake:
        mistake = SystemMistake(f"system '{self.name}': module '{module.name}': {sentence}")
        mistake.location = module.location if isinstance(module, FunctionModule) else ""
        return mistake

    def _unknown_source(self, module: Module, name: str, sources: Sequence[str]) -> SystemMistake:
        """Return the error for an argument that is not a source."""
        defaults = module.defaults if isinstance(module, FunctionModule) else {}
        if name not in defaults:
            return self._mistake(module, unknown("source", name, sources))
        constant = f"`.given({name}={shown(defaults[name])})`"
        return self._mistake(
            module, f"'{name}' has a default and is no source: give constants with {constant}"
        )

    def _check_units(self, units: Mapping[str, Any], sources: Sequence[str]) -> None:
        """Refuse sources without a unit, and names that seem misspelt.

        Other names without a source may belong to another variant.
        """
        spare = [name for name in units if name not in sources]
        for source in sources:
            cutoff = _MISSPELT if source in units else 0.6
            if misspelt := get_close_matches(source, spare, 1, cutoff):
                raise SystemMistake(
                    f"system '{self.name}': units names '{misspelt[0]}', which is no source; did "
                    f"you mean '{source}'?"
                )
            if source in units:
                continue
            raise SystemMistake(
                f"system '{self.name}': source '{source}' has no unit: add it to units, '1' for a "
                "number without one"
            )

    def _facts(
        self,
        source: str,
        units: Mapping[str, str | Mapping[str, Any]],
        shape: tuple[int, ...] | None,
    ) -> dict[str, Any]:
        """Return the fields of a source in `units`, and note the names of its numbers."""
        label = f"system '{self.name}': source '{source}'"
        entry = units[source]
        facts = {"unit": entry} if isinstance(entry, str) else dict(entry)
        if named := facts.pop("components", ()):
            self.components[source] = tuple(named)
            if shape is not None and len(named) != np.prod(shape, dtype=int):
                raise SystemMistake(
                    f"{label} has {len(named)} components and is of shape {list(shape)}: name each "
                    "of its numbers once"
                )
        return facts
