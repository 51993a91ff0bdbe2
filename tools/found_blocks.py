"""Blocks that put audits beside each other: all of them in one table, and those of one page."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from blocks import Wrong, difference, load, pipes
from latent_blocks import FAULTS
from latent_blocks import audits_of as audits_of_rooms
from state_blocks import audits_of

from faultpath.analyses import effects
from faultpath.analyses.sentences import wording

WORLD_MODEL = "stable-worldmodel"
PAGES = {
    "quadrotor-L3-decision": ("Quadrotor, 400 scenes", "quadrotor"),
    "quadrotor-L3-confirmation": ("Quadrotor, 300 scenes", "quadrotor"),
    "quadrotor-L3": ("Quadrotor, 100 scenes", "quadrotor"),
    "toy": ("Cart", "tutorial"),
    "dock": ("Docking rover", "own-loop"),
    "pendulum": ("Pendulum of Gymnasium", "gymnasium"),
    "learned-pendulum": ("Learned world model", "learned-world-model"),
    "rotorpy": ("RotorPy", "rotorpy"),
    "do-mpc": ("do-mpc", "do-mpc"),
    "motulator": ("motulator", "motulator"),
    "basilisk": ("Basilisk", "basilisk"),
    "wpilib": ("WPILib", "wpilib"),
    "openpilot-ford": ("openpilot on a Ford", "openpilot"),
    "openpilot-tesla": ("openpilot on a Tesla", "openpilot"),
    "openpilot-nissan": ("openpilot on a Nissan", "openpilot"),
    "openpilot-nissan-tolerance": ("openpilot on a Nissan", "openpilot"),
    "stable-worldmodel-rectified-moved": ("stable-worldmodel, shifted by 2 px", WORLD_MODEL),
    "stable-worldmodel-rectified-darker": ("stable-worldmodel, 30 % darker", WORLD_MODEL),
    "stable-worldmodel-augmented-moved": ("stable-worldmodel, shifted by 2 px", WORLD_MODEL),
    "stable-worldmodel-augmented-darker": ("stable-worldmodel, 30 % darker", WORLD_MODEL),
    "lerobot": ("Relative actions as in LeRobot", "lerobot"),
}
"""Title and page of the audits that reference runs hold, in the order of the table."""
CAMERAS = {
    "marked": "One camera",
    "drift": "One camera",
    "smear": "One camera",
    "blank": "One camera, blank rooms",
}
"""Names of the studies of one camera, by their file."""
REVERSAL, MISSED, ALONE = "reversal", "missed by the isolated test", "only in the isolated test"
SIZE, SAME, OPEN = "another size", "same", "inconclusive"
WORDS = (REVERSAL, MISSED, ALONE, SIZE, SAME, OPEN)
"""Words for what an isolated test says of deployment; of several modules the first is shown."""


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
        return min(words, key=lambda name: (WORDS.index(words[name]), -abs(effects[name].value)))

    @property
    def word(self) -> str:
        """The word for the test at that module."""
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


def table() -> str:
    """Return all audits: without a fault, at the module that tells most, and shared."""
    columns = ("system, repair", "no fault", "fault at one module", "fault shared", "isolated test")
    return pipes(columns, map(_row, grouped()), words=(0, 4))


def counts() -> str:
    """Return how many audits of each system came to what."""
    words: dict[str, list[str]] = {}
    for audit in (*_of_references(), *_of_studies()):
        system = f"[{audit.title.partition(', ')[0]}]({{docs}}/{audit.page}.md)"
        words.setdefault(system, []).append(audit.word)
    words["**all**"] = [word for those in words.values() for word in those]
    rows = [
        (system, str(len(those)), *(str(those.count(word) or "") for word in WORDS))
        for system, those in words.items()
    ]
    return pipes(("system", "audits", *WORDS), rows)


def grouped() -> list[list[Audit]]:
    """Return the audits; those whose faults come to the same are a group, over repairs too."""
    faults: dict[tuple[object, ...], list[Audit]] = {}
    for audit in (*_of_references(), *_of_studies()):
        signs = audit.effects[audit.module].sign, audit.effects["shared"].sign
        faults.setdefault((audit.title, audit.word, signs, audit.repair), []).append(audit)
    groups: dict[object, list[Audit]] = {}
    for (*same, _), audits in faults.items():
        groups.setdefault((*same, *(audit.fault for audit in audits)), []).extend(audits)
    return list(groups.values())


def _of_references() -> Iterator[Audit]:
    for name, (title, page) in PAGES.items():
        record = load(name).record
        effects = {effect.condition: _effect(effect) for effect in record.effects}
        turns = {change.isolated: change.turn for change in record.changes}
        yield Audit(title, page, "", f"`{record.question.repair}`", effects, turns)


def _effect(effect: effects.Effect) -> Effect:
    value, ends = effect.value, effect.interval
    if ends is None:
        raise Wrong(f"{effect.condition} has no interval: the table of all audits cannot show it")
    return Effect(value, *ends, 0 if effect.extreme else effect.sign)


def _of_studies() -> Iterator[Audit]:
    for rooms, title in CAMERAS.items():
        for audit in audits_of_rooms(rooms):
            effects = audit["effects"]
            # At a module where the fault did not act nothing was tested.
            acted = {n: t for n, t in audit["turns"].items() if effects[n] != effects["correct"]}
            named = {"fault": FAULTS[audit["fault"]], "repair": f"`{audit['repair']}`"}
            yield _of_study(title, "latent-camera", audit | named | {"turns": acted})
    for audit in audits_of():
        yield _of_study("Quadrotor's filter", "state-errors", audit)


def _of_study(title: str, page: str, audit: Mapping[str, Any]) -> Audit:
    effects = {name: Effect(*effect) for name, effect in audit["effects"].items()}
    return Audit(title, page, audit["fault"], audit["repair"], effects, audit["turns"])


def _row(audits: Sequence[Audit]) -> tuple[str, ...]:
    first, word = audits[0], audits[0].word
    page = f"[{first.title}]({{docs}}/{first.page}.md)"
    faults, repairs = (audit.fault for audit in audits), (audit.repair for audit in audits)
    modules = dict.fromkeys(audit.module for audit in audits)
    alone = [audit.effects[audit.module] for audit in audits]
    return (
        ", ".join(filter(None, dict.fromkeys((page, *faults, *repairs)))),
        _shown([audit.effects["correct"] for audit in audits]).partition(" [")[0],
        f"{' or '.join(modules)} {_shown(alone)}",
        _shown([audit.effects["shared"] for audit in audits]),
        f"**{word}**" if word == REVERSAL else word,
    )


def _shown(effects: Sequence[Effect]) -> str:
    """Return an effect with its interval, or the least and the greatest of several."""
    least, greatest = min(effects), max(effects)
    if len({effect.value for effect in effects}) == 1:
        return difference(*least[:3], bold=bool(least.sign))
    bold = all(effect.sign for effect in effects)
    ends = " to ".join(wording.signed(effect.value, 1) for effect in (least, greatest))
    return f"**{ends}**" if bold else ends


def audits(page: str) -> str:
    """Return success of baseline and repair, and their difference, for each audit of a page."""
    runs = [load(name) for name, (_, place) in PAGES.items() if place == page]
    titles = [effect.title for effect in runs[0].record.conditions]
    rows = []
    for run in runs:
        question, cells = run.record.question, map(_success, run.record.effects)
        rows.append((f"`{question.repair}`, `{question.fault}`", *cells))
    return f"{pipes(('repair, fault', *titles), rows)}\n\n{runs[0].flown}"


def _success(effect: effects.Effect) -> str:
    rates = (wording.plain(rate, 1) for rate in effect.rates)
    return f"{' → '.join(rates)}, {_shown([_effect(effect)])}"
