"""A reproduction small enough to read: claims, tables and a sweep."""

from faultpath_paper.answers import (
    ClaimVerdict,
    Ledger,
    Point,
    Reproduction,
    Series,
    StatementPart,
    Sweep,
)

from faultpath.report.tables import Entry, Line, Table

NASTY = '<script>alert("x")</script> & co'


def part(answer: str, **fields: object) -> StatementPart:
    known = {"words": f"first minus second is above -1 {NASTY}", "answer": answer}
    return StatementPart.model_validate(known | fields)


def claim(id: str, kind: str, parts: tuple[StatementPart, ...]) -> ClaimVerdict:
    first = parts[0]
    return ClaimVerdict.model_validate(
        {
            "id": id,
            "kind": kind,
            "verdict": first.answer,
            "estimate": first.estimate,
            "interval": first.interval,
            "mde": first.mde,
            "unit": first.unit,
            "paper": f"69 -> 8 {NASTY}",
            "claim": f"Coupled e=-0.1 lowers success by >= 20 pp {NASTY}",
            "parts": parts,
        }
    )


def ledger() -> Ledger:
    gain = part(
        "confirmed",
        estimate=57.3,
        interval=(48.3, 66.3),
        unit="pp",
        p_value=0.0001,
        test="sign test on scene means",
        mde=12.5,
        counts="51:0/51:1/49:1",
    )
    ratio = part("refuted", estimate=1.25, interval=(1.1, 1.4), unit="times", mde=0.2)
    same = part("undecided", estimate=-1.0, interval=(-3.3, 1.0), unit="pp", mde=24.0)
    unrun = part("undecided", reason=f"the run holds no wm-u {NASTY}")
    return Ledger(
        library=f"held-out {NASTY}",
        library_hash="9d0c31f2" * 8,
        scenes=80,
        seeds=(0, 1),
        claims=(
            claim("C01", "platform", (gain, ratio)),
            claim("C02", "finding", (ratio,)),
            claim("C03", "finding", (same, unrun)),
            claim("C04", "finding", (unrun,)),
        ),
    )


def tables() -> tuple[Table, ...]:
    first = Table(
        name="table-1",
        title=f"Success {NASTY}",
        columns=("e = 0", f"e = +0.1 {NASTY}"),
        lines=(
            Line(label="Before"),
            Line(label="WM-A", entries=(Entry(text="70.3", published="69"), Entry(text="–"))),
            Line(label=f"After {NASTY}"),
            Line(label="WM-A+DCC", entries=(Entry(text="+57.3", published="+50", detected=True),)),
        ),
        notes=(f"Three seeds {NASTY}.",),
    )
    second = Table(
        name="table-6a",
        title="Errors",
        columns=("cm",),
        lines=(Line(label="GRU", entries=(Entry(text="1.10", published="1.12"),)),),
    )
    return first, second


def sweep() -> Sweep:
    errors = (-0.3, -0.1, 0.0, 0.1, 0.3)
    return Sweep(
        name="figure-3",
        title="Success over the error",
        x_title="error e",
        y_title="success, %",
        series=tuple(
            Series(
                label=label,
                points=tuple(
                    Point(x=e, y=100 - slope * abs(e), low=95 - slope * abs(e), high=100.0)
                    for e in errors
                ),
            )
            for label, slope in ((f"WM-A {NASTY}", 300), ("WM-A+DCC", 100))
        ),
        published=f"100 throughout {NASTY}",
        notes=("Seed 0.",),
    )


def reproduction() -> Reproduction:
    return Reproduction(
        profile="paper",
        ledger=ledger(),
        tables=tables(),
        figures=(sweep(),),
        trials=12345,
        failed_trials=1,
    )
