"""The record's sentences, made from its decisions and numbers alone."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from faultpath.record.family import CORRECT, SHARED
from faultpath.record.model import Cell, Change, Effect, Path
from faultpath.record.question import Question, StopRule

FEW_TRAININGS = 10
"""With fewer, an interval for newly trained models rests on how trainings are distributed: see
docs/design/statistics.md."""
ANOTHER = (
    "Another size or sign of the fault, another library or another wiring of the system: the "
    "record speaks of the one that was run."
)


@dataclass(frozen=True)
class About:
    """What every sentence needs to know."""

    question: Question
    scenes: int
    """Compared."""
    needed: int
    """With fewer scenes, nothing can be decided."""
    small: frozenset[str] = frozenset()
    """Paths on which the difference was shown to be smaller than the margin that was asked for."""

    @property
    def sequential(self) -> bool:
        """Whether the number of scenes was not fixed beforehand."""
        return self.question.stop is not None

    @property
    def few(self) -> bool:
        """Whether there are too few scenes to decide anything."""
        return self.scenes < self.needed

    def winner(self, sign: int) -> str:
        """Return the arm of a decided side."""
        return self.question.repair if sign > 0 else self.question.baseline

    @property
    def both(self) -> str:
        """The two arms."""
        return f"{self.question.baseline} and {self.question.repair}"


def where(path: str) -> str:
    """Return a path as part of a sentence."""
    if path == CORRECT:
        return "under correct inputs"
    return "under the shared fault" if path == SHARED else f"with only the {path} struck"


def capital(words: str) -> str:
    """Return words with a capital letter in front, whatever follows."""
    return words[:1].upper() + words[1:]


def series(items: Sequence[str]) -> str:
    """Return `a`, `a and b` or `a, b and c`."""
    return " and ".join(filter(None, (", ".join(items[:-1]), items[-1])))


def estimand(question: Question) -> str:
    """Return what intervals and tests speak of."""
    if question.generalise == "models":
        return "new scenes like these and models newly trained with other seeds"
    return "new scenes like these" + (", for these trained models" if question.trained else "")


def opening(about: About, seeds: tuple[int, int]) -> tuple[str, ...]:
    """Return what a reader has to know before the numbers: their reach, and seeds that repeat.

    `seeds` are how many were run and how many of them differ.
    """
    asked, (run, differ) = about.question, seeds
    holds = "The intervals hold" if about.few else "What is decided holds"
    said = [f"{holds} for {estimand(asked)}."]
    if asked.generalise == "models" and run < FEW_TRAININGS:
        said.append(
            f"Caution: {run} trainings say little about new ones. With fewer than "
            f"{FEW_TRAININGS} their intervals hold only as far as trainings spread evenly around "
            "their mean."
        )
    elif asked.trained and asked.generalise == "scenes":
        said[0] = said[0].removesuffix(".") + "; models trained anew may differ."
    if differ < run:
        same = "All" if differ == 1 else "Some of the"
        count = "they count" if differ > 1 else "together they count"
        once = "as one" if differ == 1 else f"as {differ}"
        said.append(f"{same} {run} seeds gave the same outcome in every trial: {count} {once}.")
    return tuple(said)


def points(value: float) -> str:
    """Return a difference in percentage points with its sign; zero has none."""
    text = f"{value:+.1f}"
    return "0.0" if float(text) == 0 else text


def numbers(about: About, of: Effect | Change) -> str:
    """Return `+32.0 pp [20.1, 43.2], p < 0.001 after Holm`, and where the two disagree, which
    decides."""
    estimate = of.success if isinstance(of, Effect) else of.change
    text = f"{points(estimate.value)} pp"
    if estimate.low is not None and estimate.high is not None:
        text += f" [{plain(estimate.low)}, {plain(estimate.high)}]"
    if of.adjusted_p_value is None:
        return text
    text += f", {adjusted(about.question, of)}"
    return f"{text}: the interval alone decides nothing" if only_alone(of) else text


def adjusted(question: Question, of: Effect | Change) -> str:
    """Return `p = 0.250 after Holm`; nothing where nothing was tested."""
    p = of.adjusted_p_value
    return "" if p is None else f"p {_p(p)} {question.family}"


def only_alone(of: Effect | Change) -> bool:
    """Return whether the interval by itself leaves out 0 and yet nothing is detected."""
    estimate = of.success if isinstance(of, Effect) else of.change
    if (
        of.sign
        or of.unsettled
        or of.adjusted_p_value is None
        or estimate.low is None
        or estimate.high is None
    ):
        return False
    return estimate.low > 0 or estimate.high < 0


def effect_words(about: About, effect: Effect) -> str:
    """Say what one effect shows: who is decided to be ahead, or what could have been found."""
    place = capital(where(effect.path))
    shown = numbers(about, effect)
    if not effect.acted:
        place = "Shared" if effect.path == SHARED else place
        return f"{place}, the fault never acted on this path: nothing was tested."
    if effect.detected:
        words = f"{place}, {about.winner(effect.sign)} succeeds more often ({shown})"
        why = _extreme(effect) if effect.extreme else _uneven(about, effect)
        return f"{words}{f'; {why}, so this carries no headline' if why else ''}."
    if effect.unsettled:
        return f"{place}, nothing is decided ({shown}): trials that failed could undo it."
    if about.few:
        return f"{place}, nothing is decided ({shown}): the scenes are too few."
    if not any((*effect.wins, *effect.losses)):
        words = (
            f"{place}, both arms succeed in the same scenes; no difference is detected ({shown})"
        )
    else:
        words = f"{place}, no difference is detected ({shown})"
    if effect.path in about.small and about.question.stop:
        words += f", and it is smaller than {margin(about.question.stop)}"
    if effect.extreme:
        return f"{words}; {_extreme(effect)}, where a difference can hardly show."
    if effect.findable_pp is None:
        return f"{words}."
    least = math.ceil(effect.findable_pp)
    return f"{words}; a true one of {least} pp would be found with 80 % power."


def _uneven(about: About, effect: Effect) -> str:
    if effect.failed is None or not effect.uneven:
        return ""
    return (
        f"{effect.failed.repair} trials of {about.question.repair} and {effect.failed.baseline} "
        f"of {about.question.baseline} failed"
    )


def _extreme(effect: Effect) -> str:
    ends = "fail" if effect.extreme == "floor" else "succeed"
    rates = f"{plain(effect.baseline_percent)} and {plain(effect.repair_percent)} % success"
    return f"both arms nearly always {ends} there ({rates})"


def change_words(about: About, isolated: Effect, shared: Effect, change: Change) -> str:
    """Say whether sharing the fault reverses the ranking, changes the difference, or neither."""
    from_to = f"{points(isolated.success.value)} pp to {points(shared.success.value)} pp"
    shown = f"{from_to}; change {numbers(about, change)}"
    alone = where(isolated.path)
    if change.turn == "reversal":
        words = (
            f"Sharing the fault reverses the ranking: {alone}, {about.winner(isolated.sign)} "
            f"succeeds more often; {where(shared.path)}, {about.winner(shared.sign)} does "
            f"({shown})."
        )
        if isolated.extreme or shared.extreme:
            words += " One of the two lies at the floor or ceiling: this carries no headline."
        return words
    if change.turn == "interaction":
        return (
            f"Interaction detected: the difference is not the same {alone} as "
            f"{where(shared.path)} ({shown}); a reversal is not shown."
        )
    between = f"between the effect {alone} and that {where(shared.path)}"
    if about.few:
        return f"Nothing is decided {between} ({shown})."
    if change.unsettled:
        return f"Nothing is decided {between} ({shown}): trials that failed could undo it."
    return f"No change is detected {between} ({shown})."


def margin(rule: StopRule) -> str:
    """Return the margin below which a difference counts as small."""
    return f"{rule.margin_pp or 0.0:g} pp"


def barely_acted(
    question: Question, paths: Sequence[Path], cells: Sequence[Cell]
) -> tuple[str, ...]:
    """Name the arms that a fault should strike and changed nothing for in most of the trials."""
    of = {(cell.variant, cell.path): cell for cell in cells}
    said: list[str] = []
    for path in paths:
        arms = ((question.baseline, path.baseline_consumers), (question.repair, path.consumers))
        struck = [of[name, path.name] for name, consumers in arms if consumers]
        if not any(cell.altered_trials for cell in struck):
            continue  # the path's own sentence says that the fault never acted
        said += [
            f"{capital(where(path.name))}, the fault changed something in only "
            f"{cell.altered_trials} of {cell.trials} trials of {cell.variant}."
            for cell in struck
            if 2 * cell.altered_trials < cell.trials
        ]
    return tuple(said)


def saturated(question: Question, effects: Sequence[Effect]) -> tuple[str, ...]:
    """Say where success can hardly tell the arms apart, and what the chosen metric shows there."""
    if not question.metric:
        return ()
    metric, said = question.metrics[question.metric], list[str]()
    for effect in effects:
        found = effect.metrics.get(question.metric)
        if effect.extreme and found is not None:
            ends = f" [{found.low:.3g}, {found.high:.3g}]" if found.low is not None else ""
            said.append(
                f"Success is saturated {where(effect.path)}: the {metric.said(question.metric)} of "
                f"{question.repair} minus that of {question.baseline} is there {found.value:+.3g}"
                f"{ends} {metric.unit} ({metric.better} is better; secondary, nothing is decided "
                "from it)."
            )
    return tuple(said)


def would_change(about: About, effects: Sequence[Effect]) -> tuple[str, ...]:
    """Say what would change the verdict."""
    tested = [effect for effect in effects if effect.acted]
    lines: list[str] = []
    if about.few:
        lines.append(
            f"More scenes: with {about.needed}, a difference is found where every scene favours "
            "the same arm; a smaller one takes more."
        )
    if any(not effect.acted for effect in effects):
        lines.append(
            "A fault that acts: an onset before the trial ends, a size that changes what is read."
        )
    for extreme, advice in (
        ("floor", "Easier scenes or a smaller fault: where both arms nearly always fail, a "),
        ("ceiling", "Harder scenes or a larger fault: where both arms nearly always succeed, a "),
    ):
        if any(effect.extreme == extreme for effect in tested):
            lines.append(advice + "difference can hardly show.")
    missed: dict[int, list[str]] = {}
    for effect in tested:
        if not about.few and not effect.detected and effect.findable_pp is not None:
            least = math.ceil(effect.findable_pp)
            missed.setdefault(least, []).append(where(effect.path))
    if missed:
        listed = "; ".join(f"{least} pp {' and '.join(at)}" for least, at in missed.items())
        lines.append(
            f"Fresh scenes, which no audit has looked at, and more of them, or --stop-when, which "
            f"allows for looks: a smaller true difference than these is found with less than 80 % "
            f"power: {listed}. Adding scenes to this audit would break its 5 %."
        )
    return (*lines, ANOTHER)


def plain(value: float) -> str:
    """Return a number with one digit; zero has no sign."""
    text = f"{value:.1f}"
    return "0.0" if float(text) == 0 else text


def _p(value: float) -> str:
    if value < 0.001:
        return "< 0.001"
    text = f"{value:.3f}"
    return f"= {value:.4f}" if text == "0.050" and value != 0.05 else f"= {text}"
