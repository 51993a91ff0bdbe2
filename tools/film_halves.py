"""What all films have in common: one scene, with a fault at one module and with it shared."""

from collections import Counter
from collections.abc import Callable, Mapping
from functools import cache
from itertools import product
from pathlib import Path
from string import Template
from typing import Any, NamedTuple

import yaml
from blocks import OUTCOMES, REFERENCE, Picture, Run, Wrong, load
from film import OTHER_SIGN, SIGNS, Film
from pydantic import BaseModel

from faultpath.analyses.effects import Effect
from faultpath.api.replaying import outcomes_at
from faultpath.report.sentences import wording
from faultpath.report.svg import number
from faultpath.run.store.folder import read_outcomes
from faultpath.run.store.tables import TrialAddress
from faultpath.system import Outcome, Status

CARD, GAP, PAD = 412.0, 16.0, 14.0
"""Width of a half, pixels between the halves, and around what is in one."""
TOP, HEAD, FOOT = 34.0, 62.0, 112.0
"""Heights of the legend, of the titles of a half, and of the numbers below its scene."""
WIDTH = 2 * CARD + GAP
SIDES = ("baseline", "repair")
_ROW = 22.0
_CHIP = 92.0


class Half(BaseModel):
    """One side of a film: its condition, the titles, and each reader with whether it reads wrong
    values."""

    condition: str
    over: str
    title: str
    readers: dict[str, bool]


class Story(BaseModel):
    """A scene of a reference run under two conditions, and the words for what happens."""

    run: str
    scene: str
    seed: int
    halves: tuple[Half, Half]
    variants: dict[str, str]
    """What each is, the baseline first."""
    during: str
    ends: dict[Status, str]

    def trials(self, half: Half) -> dict[str, Outcome]:
        """Return the trials of a half by variant."""
        places = {
            variant: TrialAddress(variant, half.condition, self.seed, self.scene)
            for variant in self.variants
        }
        return {variant: outcomes(self.run)[at] for variant, at in places.items()}

    @property
    def longest_s(self) -> float:
        """Time of the trial that lasts longest."""
        return max(trial.time_s for half in self.halves for trial in self.trials(half).values())


STORIES = yaml.safe_load(Path(__file__).with_name("films.yaml").read_text("utf-8"))


def told(name: str, **scene: Any) -> Story:
    """Return a story, in a scene where `films.yaml` has none."""
    return Story(**STORIES[name], **scene)


class Pace(NamedTuple):
    """Seconds that show one of the trial, that the last picture stays, that a tick of the clock
    takes; and second of the still, by default the last."""

    slow: float
    hold_s: float
    tick_s: float
    still_s: float | None = None


@cache
def outcomes(run: str) -> Mapping[TrialAddress, Outcome]:
    """Return all trials of a reference run."""
    return outcomes_at(read_outcomes(REFERENCE / run / OUTCOMES))


def picture(
    name: str,
    story: Story,
    pace: Pace,
    height: float,
    draw: Callable[[Film, Half, float, float], None],
    **sizes: str,
) -> Picture:
    """Return a film with its still; `draw` draws a half's scene, of a height, at a left and top.

    `sizes` are what the film's styles name.
    """
    styles = (
        path.read_text("utf-8")
        for path in map(Path(__file__).with_name, ("film.css", f"film_{name}.css"))
    )
    css = Template("\n" + "\n".join(styles)).substitute(sizes)
    film = Film(WIDTH, TOP + HEAD + height + FOOT, alternative(story), css)
    still_s = story.longest_s if pace.still_s is None else pace.still_s
    film.times(story.longest_s, pace.slow, pace.hold_s, still_s)
    legend(film, story)
    film.clock(pace.tick_s, WIDTH)
    for place, half in enumerate(story.halves):
        left = place * (CARD + GAP)
        film.rect(left, TOP, CARD, HEAD + height + FOOT, "card", 10)
        title(film, half, left)
        draw(film, half, left + PAD, TOP + HEAD)
        numbers(film, story, half, left, TOP + HEAD + height)
    content = alternative(story), film.written(True), film.written(False), caption(story)
    return Picture(f"film-{name}.svg", *content)


def legend(film: Film, story: Story) -> None:
    """Draw what the two colours are."""
    left = 0.0
    for side, (variant, words) in zip(SIDES, story.variants.items(), strict=True):
        film.circle((left + 6, 11), 6, f"dot {side}")
        film.text(left + 18, 16, variant, f"name {side}")
        left += 26 + 8.2 * len(variant)
        film.text(left, 16, words, "soft")
        left += 26 + 6.4 * len(words)


def title(film: Film, half: Half, left: float) -> None:
    """Draw the titles of a half, and who reads the wrong values."""
    film.text(left + PAD, TOP + 24, half.over, "soft")
    film.text(left + PAD, TOP + 45, half.title, "title")
    chip = left + CARD - PAD - _CHIP
    source = chip - 22, TOP + 31
    for place, (reader, wrong) in enumerate(half.readers.items()):
        hit, y = " hit" if wrong else "", TOP + 20 + 22 * place
        x0, y0, x1 = number(source[0]), number(source[1]), number(chip)
        bend = (
            f"C{number(source[0] + 14)} {y0} {number(source[0] + 9)} {number(y)} {x1} {number(y)}"
        )
        film.path(f"M{x0} {y0}{bend}", f"wire{hit}")
        film.rect(chip, y - 9.5, _CHIP, 19, f"chip{hit}", 5)
        colour = "faulted" if wrong else "soft"
        film.text(chip + _CHIP / 2, y + 4, reader, f"small {colour}", "middle")
    film.circle(source, 5, "source wrong")


def numbers(film: Film, story: Story, half: Half, left: float, top: float) -> None:
    """Write how each trial of a half ends, and how often each variant succeeds in all scenes."""
    run = load(story.run)
    (effect,) = (e for e in run.record.effects if e.condition == half.condition)
    y, words, bars, right = top + 24, left + 104, left + 246, left + CARD - PAD
    wide = right - 52 - bars
    film.text(words, y, "in this scene", "small soft")
    film.text(bars, y, f"success in all {run.record.scenes} scenes", "small soft")
    rows = zip(SIDES, story.trials(half).items(), effect.rates, strict=True)
    for side, (variant, trial), rate in rows:
        y += _ROW
        film.circle((left + PAD + 5, y - 4.5), 5, f"dot {side}")
        film.text(left + PAD + 16, y, variant, f"name {side}")
        with film.group(f"{side} {film.appearing(trial.time_s)}"):
            sign = f"translate({number(words + 5)},{number(y - 5)}) scale(.75)"
            film.path(SIGNS.get(trial.status, OTHER_SIGN), "sign", transform=sign)
            film.text(words + 16, y, f"{story.ends[trial.status]}, {trial.time_s:.2f} s")
        with film.group(film.vanishing(trial.time_s), opacity="0"):
            film.text(words + 16, y, story.during, "soft")
        film.rect(bars, y - 10, wide, 11, "track", 3)
        film.rect(bars, y - 10, wide * rate / 100, 11, f"bar {side}", 3)
        film.text(right, y, f"{rate:.1f} %", "", "end")
    film.text(right, y + 26, conclusion(run, effect), "name" if effect.sign else "", "end")


def conclusion(run: Run, effect: Effect) -> str:
    """Say which variant all scenes show to be ahead under a condition, with the interval."""
    low, high = effect.interval or (effect.value, effect.value)
    if not effect.sign:
        value, *ends = (wording.signed(number, 1) for number in (effect.value, low, high))
        return f"no significant difference: {value} pp [{', '.join(ends)}]"
    low, high = sorted((abs(low), abs(high)))
    ahead = f"{run.record.winner(effect.sign)} ahead by {abs(effect.value):.1f} pp"
    return f"{ahead} [{low:.1f}, {high:.1f}]"


def alternative(story: Story) -> str:
    """Say what the film shows, for readers who do not see it."""
    halves = (
        f"{half.over} {half.title}: "
        + ", ".join(f"{v} {story.ends[t.status]}" for v, t in story.trials(half).items())
        for half in story.halves
    )
    return f"The same scene twice. {'. '.join(halves)}."


def caption(story: Story) -> str:
    """Say how the scene was chosen, and how many go like it and the other way round."""
    facts = load(story.run).record.facts
    at = product(story.halves, story.variants)
    places = [(variant, half.condition) for half, variant in at]
    counts = Counter(
        tuple(
            outcomes(story.run)[TrialAddress(*place, seed, scene)].status is Status.SUCCESS
            for place in places
        )
        for scene in {trial.scene for trial in outcomes(story.run)}
        for seed in facts.seeds
    )
    baseline, repair = story.variants
    succeeds = [
        trial.status is Status.SUCCESS for h in story.halves for trial in story.trials(h).values()
    ]
    if succeeds[0] == succeeds[1] or not all(succeeds[2:]):
        raise Wrong(f"{story.scene} does not show what the caption says: choose another scene")
    winner, loser = (baseline, repair) if succeeds[0] else (repair, baseline)
    alike, opposite = (counts[first, not first, True, True] for first in succeeds[:2])
    of = f"{counts.total():,} scenes"
    if len(facts.seeds) > 1:
        of = f"{counts.total():,} cases ({facts.n_scenes} scenes, each with {len(facts.seeds)} "
        of += "trainings)"
    versions = "; ".join(f"`{name}`: {words}" for name, words in story.variants.items())
    return (
        f"{versions}. One of {of}, chosen because it shows what the numbers below it say. "
        f"{alike} go like it: with the fault at one module alone `{winner}` succeeds and `{loser}` "
        f"does not; with the fault shared both succeed. {opposite or 'None'} go the other way "
        "round."
    )
