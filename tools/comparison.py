"""Audits beside each other, over all systems: what a test at one module says of deployment."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from blocks import Run, Wrong, load
from rendering import difference
from studies import WORDS, camera, sensors

from faultpath.analyses import effects
from faultpath.report.sentences import wording

PAGES, ANSWERS = WORDS["runs"], WORDS["answers"]
REVERSAL, MISSED, ALONE, SIZE, SAME, OPEN = ANSWERS
"""Words for what an isolated test says of deployment."""


class Effect(NamedTuple):
    """A difference in success, pp, its interval, and the sign that is decided, or 0."""

    value: float
    low: float
    high: float
    sign: int


class Audit(NamedTuple):
    """An audit of the table; `turns` says by module what is decided of shared against alone."""

    title: str
    page: str
    fault: str
    """Empty for the one fault of its page."""
    repair: str
    effects: Mapping[str, Effect]
    turns: Mapping[str, str]

    @property
    def words(self) -> dict[str, str]:
        """Words for what the test at each module says of deployment."""
        shared = self.effects["shared"]
        return {
            name: verdict(self.effects[name], shared, turn) for name, turn in self.turns.items()
        }

    @property
    def module(self) -> str:
        """The module that tells most."""
        words, effects = self.words, self.effects
        return min(
            words, key=lambda name: ([*ANSWERS].index(words[name]), -abs(effects[name].value))
        )

    @property
    def alone(self) -> Effect:
        """The effect at that module."""
        return self.effects[self.module]

    @property
    def word(self) -> str:
        """The word for the test there."""
        return self.words[self.module]


def verdict(alone: Effect, shared: Effect, turn: str) -> str:
    """Return what the test at one module says of deployment.

    `turn` is `none`, `interaction` or `reversal`: what is decided of the two effects' difference.
    """
    if turn == "none":
        return SAME if alone.sign == shared.sign != 0 else OPEN
    if alone.sign and shared.sign:
        return REVERSAL if turn == "reversal" else SIZE
    return MISSED if shared.sign else ALONE if alone.sign else OPEN


def by_system() -> dict[str, list[str]]:
    """Return the words of the audits of each system, which links to its page."""
    words: dict[str, list[str]] = {}
    for audit in every_audit():
        system = audit.title.partition(", ")[0].partition(" on a ")[0]
        mark = " (teaching example)" if audit.page in WORDS["teaching"] else ""
        words.setdefault(f"[{system}]({{docs}}/{audit.page}.md){mark}", []).append(audit.word)
    return words


def answer(words: Sequence[str]) -> str:
    """Return what the audits of a system say of its tests of one module, each with its count."""
    counts = {text: words.count(word) for word, text in ANSWERS.items() if word in words}
    several = len(words) > 1
    return "; ".join(f"{text} ({n})" if several else text for text, n in counts.items())


def grouped() -> list[list[Audit]]:
    """Return the audits; those whose faults come to the same are a group, over repairs too."""
    faults: dict[tuple[object, ...], list[Audit]] = {}
    for audit in every_audit():
        signs = audit.effects[audit.module].sign, audit.effects["shared"].sign
        faults.setdefault((audit.title, audit.word, signs, audit.repair), []).append(audit)
    groups: dict[object, list[Audit]] = {}
    for (*same, _), audits in faults.items():
        groups.setdefault((*same, *(audit.fault for audit in audits)), []).extend(audits)
    return list(groups.values())


def every_audit() -> Iterator[Audit]:
    """Yield the audits of reference runs, then those of studies."""
    for name, (title, page) in PAGES.items():
        record = load(name).record
        effects = {effect.condition: _effect(effect) for effect in record.effects}
        turns = {change.isolated: change.turn for change in record.changes}
        yield Audit(title, page, "", f"`{record.question.repair}`", effects, turns)
    for rooms, title in WORDS["cameras"].items():
        for audit in camera(rooms, "held-out")["audits"]:
            fault, repair = WORDS["camera_faults"][audit["fault"]], f"`{audit['repair']}`"
            effects = audit["effects"]
            # At a module where the fault did not act nothing was tested.
            acted = {n: t for n, t in audit["turns"].items() if effects[n] != effects["correct"]}
            yield Audit(title, "latent-camera", fault, repair, _shown(effects), acted)
    for audit in sensors().audits:
        title, page, effects = "Quadrotor's filter", "state-errors", _shown(audit.effects)
        yield Audit(title, page, audit.fault, audit.repair, effects, audit.turns)


def _effect(effect: effects.Effect) -> Effect:
    value, ends = effect.value, effect.interval
    if ends is None:
        raise Wrong(f"{effect.condition} has no interval: the table of all audits cannot show it")
    return Effect(value, *ends, 0 if effect.extreme else effect.sign)


def _shown(effects: Mapping[str, Any]) -> dict[str, Effect]:
    return {name: Effect(*effect) for name, effect in effects.items()}


def between(effects: Iterable[Effect]) -> str:
    """Return an effect with its interval, or the least and the greatest of several."""
    effects = list(effects)
    least, greatest = min(effects), max(effects)
    if len({effect.value for effect in effects}) == 1:
        return difference(*least[:3], bold=bool(least.sign))
    bold = all(effect.sign for effect in effects)
    ends = " to ".join(wording.signed(effect.value, 1) for effect in (least, greatest))
    return f"**{ends}**" if bold else ends


def runs_of(page: str) -> list[Run]:
    """Return the reference runs that a page is about."""
    return [load(name) for name, (_, place) in PAGES.items() if place == page]


def success(effect: effects.Effect) -> str:
    """Return success of baseline and repair, and their difference."""
    rates = (wording.plain(rate, 1) for rate in effect.rates)
    return f"{' → '.join(rates)}, {between([_effect(effect)])}"


def means(of: tuple[float, float]) -> str:
    """Return the means of a metric, of baseline and repair."""
    return " → ".join(f"{value:.3g}" for value in of)
