"""The prose of `docs/performance.md` and how its numbers are written."""

from dataclasses import dataclass

HEAD = """\
# Performance

How fast faultpath is beside other software that does the same work. `make bench` measures
everything again and writes this page; nothing on it is typed. `benchmarks/results.json` holds the
numbers, `benchmarks/` how they were come by.

```console not-run
$ make bench
$ make bench ARGS="--only rollout plant"
```

The peers live in an environment of their own, `.venv-bench`, with the versions of
`benchmarks/requirements.txt`. faultpath itself needs none of them.

**Method.** Each side is a process of its own, with one thread, on one and the same processor. The
sides take turns: in a round each works for about a quarter of a second, and there are several
rounds. Rounds are timed in processor time of all the side's threads, which other work on the
machine does not lengthen; single replans and whole commands are timed by the clock on the wall. A
row gives the median over the rounds. The ratio is formed within each round, then its
median is taken; brackets hold the smallest and the largest round. Where two sides should give the
same numbers, that is checked first, and a side that differs is not timed. In a row with a rate or
a plain time a ratio above one means that faultpath is faster; a row that bounds a cost says "at
most".

**Not measured.** Nothing was measured on a GPU: there was none. jax_mppi is on no package index
that the set-up reads; the JAX scan, which is the rollout alone, stands for it."""


@dataclass(frozen=True)
class Section:
    """A part of the page and the comparisons that it shows."""

    title: str
    comparisons: tuple[str, ...]
    words: str
    picture: str = ""


SECTIONS = (
    Section(
        "Rollout of the learned model",
        ("rollout",),
        """\
The planner's cost is the rollout of WM-A with wind: 512 candidates, 20 steps, float32, one scene.
"Fused" is the compiled kernel, "portable" the same arithmetic in torch. The JAX scan is the model
written by hand with `lax.scan` and `jit`, in two layouts of the network. The share of `torch.mm` is
the rate of the network's affine maps alone over that of a product of two square matrices of 1024
rows in the same round; kinematics and activations take time too but count for nothing there. The
product "on a layer" is of 64 x 64 by 64 x 512.""",
    ),
    Section(
        "Whole replans",
        ("replan", "compiled"),
        """\
Noise, rollout, costs and the update. Ours pays for all terms of its cost, the peers for a goal and
a speed term only. pytorch_mppi gets the model as its documentation asks for, a dynamics function
over `[K, nx]`, written with `torch.nn`; it has no batch of scenes, so sixteen are planned one after
the other. In "our layout" its dynamics are views of our own portable predictor, which shows what
the library itself costs; "compiled" is its own `compile`, that is torch.compile. torchrl's planner
gets one round of optimisation and all candidates.""",
    ),
    Section(
        "Closed loop",
        ("closed-loop",),
        """\
A block of 50 selection scenes at wind level L3, flown for 20 control steps with the variant `gru`:
readings through taps, history code, wind reconstruction, noise, rollout, clearance along all
candidates, costs, update, plant. Times are per running scene and step, against the rollout of as
many scenes alone. Below each, what the time goes into. The clock of a part includes what it
calls; "taps and everything else" is the rest.""",
    ),
    Section(
        "What each kernel buys",
        ("kernels",),
        """\
The flights of the closed loop above, with all compiled kernels and with the portable form of one
of them, in turn in one process: by how much the processor time of the flights grows without it,
from the parts of a step that it changes. An audit is such flights and little else. Blocks of 5
scenes, as an audit of few scenes has them, spread what a call costs over fewer scenes. What follows
for kernels below 2 % stands in `docs/design/kernels.md`.""",
    ),
    Section(
        "One vehicle",
        ("latency",),
        """\
A thousand replans of one vehicle, each timed by itself: noise, rollout, clearance along all
candidates, costs and update on one core. The paper's core runs at 42 Hz on a flight computer.""",
    ),
    Section(
        "Plant",
        ("plant",),
        """\
Steps of 2 ms in float64 with rate loop, mixer, motor limits and lag, drag and wind, for 100
vehicles of different parameters. RotorPy's batched multirotor has other aerodynamics but the same
parts. MuJoCo flies our vehicle's model one after the other: with the rate loop in Python at each
step, or without any, which is the least that it can be asked for.""",
    ),
    Section(
        "Depth images",
        ("depth",),
        """\
The images of 25 selection scenes, from where the vehicles start, against one call of `mj_multiRay`
an image over the same boxes, pillars and walls.""",
    ),
    Section(
        "Statistics",
        ("bootstrap",),
        """\
A paired percentile bootstrap of 100 scenes and 3 seeds with 10,000 resamples. An audit draws its
resamples once and uses them for every effect: the second row is what each further effect costs.""",
    ),
    Section(
        "Scaling and memory",
        ("scaling", "workers"),
        """\
The rollout over candidates, steps and scenes: the time at the largest size against what the
smallest foretells; below one it grows more slowly than the size. The small audit is the main job
on a few selection scenes, from the start of the command to its report. Two processors may share
what a core has: matrix products in two processes show what the machine gives the second.""",
        "![Time of a rollout over candidates, steps and scenes](images/performance-scaling.svg)",
    ),
    Section(
        "Start-up",
        ("start-up",),
        "From the start of the process to its end; the files are in the system's cache.",
    ),
)


def number(value: float) -> str:
    """Return three significant digits, thousands apart."""
    if value >= 1000:
        digits = 10 ** (len(str(int(value))) - 3)
        return f"{round(value / digits) * digits:,}".replace(",", " ")
    return f"{value:.3g}"
