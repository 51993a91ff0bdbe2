"""The record's sentences, made from its numbers alone."""

from collections.abc import Sequence

from faultpath.record.model import Effect, PathBreakEven, Question, Reversal, Verdict

CORRECT = "correct"
SHARED = "shared"


def effect_words(question: Question, effect: Effect) -> str:
    """Say what one effect shows, with what could have been detected where nothing was."""
    where = path_words(effect.path)
    shown = effect.success.text()
    if effect.detected:
        better = question.repair if effect.success.value > 0 else question.baseline
        return f"{where}, {better} succeeds more often ({shown})."
    if effect.minimum_detectable_pp is None:
        return f"{where}, no difference is detected ({shown})."
    return (
        f"{where}, no difference is detected ({shown}); a true one of "
        f"{effect.minimum_detectable_pp:.0f} pp would be, with 80 % power."
    )


def path_words(path: str) -> str:
    """Return a path as the beginning of a sentence."""
    if path == CORRECT:
        return "Under correct inputs"
    return "Under the shared fault" if path == SHARED else f"Under the fault at the {path} only"


def reversal_words(question: Question, isolated: Effect, shared: Effect, turned: bool) -> str:
    """Say whether sharing the fault turns the verdict round."""
    change = f"{isolated.success.value:+.1f} pp to {shared.success.value:+.1f} pp"
    if turned:
        first, second = (question.repair, question.baseline)
        if isolated.success.value < 0:
            first, second = second, first
        return (
            f"Sharing the fault turns the answer round: {first} is ahead when only the "
            f"{isolated.path} is struck, {second} when the fault is shared ({change}); both "
            "are detected."
        )
    return (
        f"Sharing the fault does not turn the verdict on the {isolated.path}-only fault round "
        f"({change})."
    )


def verdict(
    question: Question,
    effects: Sequence[Effect],
    break_even: Sequence[PathBreakEven],
    reversals: Sequence[Reversal],
) -> Verdict:
    """Put the answer into words."""
    sentences = [effect.words for effect in effects]
    if break_even:
        clauses = [f"{_under(item.path)} it {item.result.words}" for item in break_even]
        sentences.append(f"{question.repair} by fault frequency: {'; '.join(clauses)}.")
    sentences += [item.words for item in reversals]
    return Verdict(
        headline=_headline(question, effects, reversals),
        sentences=tuple(sentences),
        would_change=tuple(_would_change(question, effects, break_even)),
    )


def _headline(question: Question, effects: Sequence[Effect], reversals: Sequence[Reversal]) -> str:
    repair, baseline = question.repair, question.baseline
    turned = [item for item in reversals if item.reversed]
    if turned:
        # An isolated effect that was itself detected makes the stronger headline.
        detected = {effect.path for effect in effects if effect.detected}
        turned = [item for item in turned if item.isolated in detected] or turned
        if turned[0].isolated not in detected:
            turned = turned[:1]
        found = {effect.path: effect for effect in effects}
        where = " or the ".join(item.isolated for item in turned)
        alone = _ahead(question, found[turned[0].isolated])
        shared = _ahead(question, found[turned[0].shared])
        return (
            f"Do not choose by the isolated fault: struck at the {where} alone, {alone}; "
            f"with the fault shared, {shared}."
        )
    better = [e for e in effects if e.detected and e.success.value > 0]
    worse = [e for e in effects if e.detected and e.success.value < 0]
    if better and not worse:
        rest = len(effects) - len(better)
        everywhere = "on every path" if not rest else f"on {len(better)} of {len(effects)} paths"
        tail = "" if not rest else ", and on no path is a loss detected"
        return f"{repair} is favoured over {baseline} {everywhere}{tail}."
    if worse and not better:
        return f"{repair} is not favoured: it loses to {baseline} {_list_paths(worse)}."
    if better and worse:
        return (
            f"It depends on the fault's path: {repair} beats {baseline} {_list_paths(better)} "
            f"and loses {_list_paths(worse)}."
        )
    return f"No difference between {repair} and {baseline} is detected on any path."


def _ahead(question: Question, effect: Effect) -> str:
    """Say who is ahead on a path, or that nobody was found to be."""
    if not effect.detected:
        return f"no difference is detected ({effect.success.value:+.1f} pp)"
    return f"{question.repair if effect.success.value > 0 else question.baseline} is ahead"


def _list_paths(effects: Sequence[Effect]) -> str:
    return ", ".join(_under(effect.path) for effect in effects)


def _under(path: str) -> str:
    if path == CORRECT:
        return "under correct inputs"
    return "under the shared fault" if path == SHARED else f"under {path}-only corruption"


def _would_change(
    question: Question, effects: Sequence[Effect], break_even: Sequence[PathBreakEven]
) -> list[str]:
    lines = [
        f"More scenes: one of {effect.minimum_detectable_pp:.0f} pp {_under(effect.path)} would be "
        f"detected with 80 % power, and smaller ones more rarely."
        for effect in effects
        if not effect.detected and effect.minimum_detectable_pp is not None
    ]
    lines.append(
        "Another size or sign of the fault, another library or another wiring of the system: the "
        "record speaks of the one that was run."
    )
    return lines
