"""Recorded flights: what is read of them, what it shows, and the sentence for every mistake."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from faultpath_quadrotor.flightlog.compensation import Compensation, compensation
from faultpath_quadrotor.flightlog.flight import INTERVAL_S, Flight, read_flight
from faultpath_quadrotor.flightlog.reading import read_columns
from faultpath_quadrotor.flightlog.words import sentences
from flight_logs import MAP, flown, map_file, read, write, write_ulog
from typer.testing import CliRunner

from faultpath.cli.app import build
from faultpath.core.errors import UserError

COLUMNS = flown()


def odd(name: str, value: float) -> Any:
    """Return what puts a value into one cell of a column."""

    def change(columns: dict[str, Any]) -> Any:
        found = np.array(columns[name], dtype=np.float64)
        found[100] = value
        return found

    return change


def found(folder: Path, columns: dict[str, Any] = COLUMNS, text: str = MAP) -> Flight:
    return read(write(folder / "flight.csv", columns), text)


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Flight:
    return found(tmp_path_factory.mktemp("log"))


@pytest.fixture(scope="module")
def known(flight: Flight) -> Compensation:
    return compensation(flight)


def numbers(flight: Flight) -> np.ndarray[Any, Any]:
    """Return all that is read of each interval."""
    turned = flight.rotation.as_matrix().reshape(-1, 9)
    moved = flight.acceleration_mps2, flight.velocity_mps
    return np.column_stack([flight.stretch, flight.time_s, flight.thrust_n, turned, *moved])


def median(result: Compensation, observer: float, predictor: float) -> float:
    errors = {(each.observer, each.predictor): each.error_mps2 for each in result.combinations}
    return errors[observer, predictor].value


def test_an_isolated_error_adds_and_a_shared_one_cancels(known: Compensation) -> None:
    """a_0 is a fifth of a weight off; the observer makes up for it where both are."""
    correct = median(known, 0.0, 0.0)
    assert correct < 0.1
    assert median(known, 0.1, 0.0) == pytest.approx(0.2 * 9.81, rel=0.1)
    assert median(known, 0.0, 0.1) == pytest.approx(0.2 * 9.81 / 1.1, rel=0.1)
    assert median(known, 0.1, 0.1) < 2 * correct
    assert [each.decided for each in known.shared] == ["less", "less"]


def test_without_delay_and_filter_nothing_of_a_shared_error_is_left(tmp_path: Path) -> None:
    """Eq. 2: in steady flight the estimate is that of the interval itself."""
    still = {name: np.full_like(values, values[0]) for name, values in COLUMNS.items()}
    still |= {"t": COLUMNS["t"], "qw": np.ones(len(COLUMNS["t"]))}
    still |= dict.fromkeys(("qx", "qy", "qz"), 0 * still["qw"])
    still["thrust"] = np.full(len(still["t"]), 1.4 * 9.80665)
    for axis in ("vx", "vy", "vz"):
        still[axis] = 0.3 * still["t"]
    text = MAP.replace("drag_kgps: [0.3, 0.3, 0.6]", "")
    result = compensation(found(tmp_path, still, text))
    assert median(result, 0.1, 0.1) == pytest.approx(0.0, abs=1e-4)
    assert median(result, 0.1, 0.0) > 1.5


@pytest.mark.parametrize("name", ["flight.csv", "flight.parquet"])
def test_a_file_of_any_kind_holds_the_same_flight(tmp_path: Path, flight: Flight, name: str):
    assert np.array_equal(numbers(read(write(tmp_path / name, COLUMNS))), numbers(flight))


def test_cells_of_parquet_may_hold_lists(tmp_path: Path, flight: Flight) -> None:
    columns: dict[str, Any] = {"t": COLUMNS["t"], "thrust": COLUMNS["thrust"]}
    for list_, of in (("q", ("qw", "qx", "qy", "qz")), ("v", ("vx", "vy", "vz"))):
        columns[list_] = np.stack([COLUMNS[each] for each in of], axis=1).tolist()
    text = MAP.replace("qw, qx, qy, qz", "'q[0]', 'q[1]', 'q[2]', 'q[3]'")
    text = text.replace("vx, vy, vz", "'v[0]', 'v[1]', 'v[2]'")
    log = write(tmp_path / "flight.parquet", columns)
    assert np.array_equal(numbers(read(log, text)), numbers(flight))
    for old, new in (("'v[2]'", "'v[3]'"), ("'v[2]'", "v")):
        with pytest.raises(UserError, match=r"column 'v' holds list<.*> and no numbers for v"):
            read(log, text.replace(old, new))


def test_other_units_frames_and_orders_hold_the_same_flight(tmp_path, flight):
    other = dict(COLUMNS)
    other["t"] = COLUMNS["t"] * 1e6
    for name in ("vx", "vy", "vz", "qy", "qz"):
        other[name] = COLUMNS[name] * (1 if name == "vx" else -1)
    other |= {name: other[name] * 100 for name in ("vx", "vy", "vz")}
    text = MAP.replace("unit: s", "unit: us").replace("ENU", "NED")
    text = text.replace("vz]", "vz], unit: cm/s").replace("[qw, qx, qy, qz]", "[qx, qy, qz, qw]")
    same = found(tmp_path, other, text.replace("wxyz", "xyzw"))
    np.testing.assert_allclose(numbers(same), numbers(flight), rtol=1e-6, atol=1e-6)


def test_px4_logs_are_read_with_the_map_that_ships(tmp_path: Path) -> None:
    pytest.importorskip("pyulog")
    log = write_ulog(tmp_path / "flight.ulg", COLUMNS)
    columns = read_columns("px4").model_copy(update={"mass_kg": 1.5})
    flight = read_flight(log, columns)
    assert flight.newton_per_unit == pytest.approx(-30.0, rel=0.05)
    result = compensation(flight)
    assert median(result, 0.1, 0.0) == pytest.approx(0.2 * 9.81, rel=0.15)
    assert result.shared[0].decided == "less"


def test_a_gap_ends_a_stretch_and_the_rest_counts(tmp_path: Path) -> None:
    keep = (COLUMNS["t"] < 20) | (COLUMNS["t"] > 24)
    result = compensation(found(tmp_path, {n: values[keep] for n, values in COLUMNS.items()}))
    assert result.gaps == 1
    assert result.flown_s == pytest.approx(56, abs=0.2)
    assert median(result, 0.0, 0.0) < 0.1


def test_a_pause_before_the_flight_or_after_it_is_none_of_it(tmp_path: Path) -> None:
    """One message is sent alone, long before all others are, or after they have ended."""
    pytest.importorskip("pyulog")
    columns = read_columns("px4").model_copy(update={"mass_kg": 1.5})
    late = {"vehicle_thrust_setpoint": (0.002, 10.0), "vehicle_attitude": (-1.0, 20.0)}
    early = {"vehicle_thrust_setpoint": (50.0, 59.99), "vehicle_attitude": (40.0, 61.0)}
    for quiet, begin_s in ((late, 20.0), (early, 0.0)):
        flight = read_flight(write_ulog(tmp_path / "a.ulg", COLUMNS, quiet=quiet), columns)
        assert flight.gaps == 0
        assert flight.time_s[0] == pytest.approx(begin_s, abs=0.01)
        assert len(flight.time_s) == pytest.approx(40 / INTERVAL_S, abs=2)


@pytest.mark.parametrize("decided", ["less", "more", "not decided"])
def test_only_what_is_decided_is_said(known: Compensation, decided: Any) -> None:
    shared = tuple(each.model_copy(update={"decided": decided}) for each in known.shared)
    for sentence in sentences(known.model_copy(update={"shared": shared})):
        assert ("sharing compensates: the error is" in sentence) == (decided == "less")
        assert ("sharing makes it worse: the error is" in sentence) == (decided == "more")
        assert ("do not show whether" in sentence) == (decided == "not decided")


@pytest.mark.parametrize(
    ("change", "text", "says"),
    [
        ({}, MAP.replace("wxyz", "xyzw"), "correct the order of the attitude"),
        ({}, MAP.replace("unit: s", "unit: ns"), "correct the unit of time"),
        ({}, MAP.replace("mass_kg: 1.5", "mass_kg: 15"), "times the weight: correct mass_kg"),
        ({}, MAP.replace("mass_kg: 1.5", ""), "the mass of the vehicle is not given"),
        ({}, MAP.replace("qw,", "qv,"), "column 'qv'"),
        ({}, MAP.replace("frame: ENU", "frame: UP"), "frame: is 'UP', and must be 'NED' or 'ENU'"),
        ({}, MAP.replace("time: {column: t, unit: s}", ""), "the map names no time column"),
        ({"qw": lambda c: 2 * c["qw"]}, MAP, "a unit quaternion has 1"),
        ({"t": lambda c: c["t"][::-1]}, MAP, "go back at its reading 1: sort the rows"),
        ({"vx": lambda c: c["vx"] * np.nan}, MAP, "column 'vx' has fewer than two numbers"),
        ({"vx": lambda c: c["vx"].astype(str)}, MAP.replace("vx", "word"), "column 'word'"),
        ({"vx": lambda c: c["vx"] > 0}, MAP, "column 'vx' holds bool and no numbers"),
        *(
            ({name: odd(name, value)}, MAP, f"column '{name if name != 't' else 'qw'}' reach")
            for name in ("t", "qw", "vx", "thrust")
            for value in (np.inf, -1e308)
        ),
        ({"qx": odd("qx", 3.0)}, MAP, "at its reading 100, and a unit quaternion has 1"),
        ({n: odd(n, 0.0) for n in ("qw", "qx", "qy", "qz")}, MAP, "length 0 at its reading 100"),
        *(
            ({}, MAP.replace(old, f"{old.split()[0]} {new}"), f"line 7: {says}")
            for old, new, says in (
                ("mass_kg: 1.5", "true", "mass_kg: is true, and must be a number"),
                ("mass_kg: 1.5", "0", "mass_kg: "),
            )
        ),
        ({}, MAP.replace("mass_kg: 1.5", "mass_kg: 1e308"), "times the weight: correct mass_kg"),
        ({}, MAP.replace("[0.3, 0.3, 0.6]", "[0, 0.3, 0.6]"), "drag_kgps[0]: "),
        ({}, MAP.replace("thrust}", "thrust, newton_per_unit: 1e308}"), "or newton_per_unit of"),
    ],
)
def test_a_mistake_is_one_sentence(tmp_path, change, text, says):
    short = {name: values[:4000] for name, values in COLUMNS.items()}
    columns = short | {name: make(short) for name, make in change.items()}
    columns["word"] = np.array(["high"] * len(short["t"]))
    if says == "column 'word'":
        says = "column 'word' holds string and no numbers"
    with pytest.raises(UserError) as caught:
        found(tmp_path, columns, text)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_the_command_prints_what_it_found(tmp_path: Path, known: Compensation) -> None:
    log = write(tmp_path / "flight.csv", COLUMNS)
    line = ["log", str(log), "--columns", map_file(tmp_path)]
    printed = CliRunner().invoke(build(line), line, catch_exceptions=False)
    assert printed.exit_code == 0
    assert "sharing compensates: the error is 0." in " ".join(printed.output.split())
    again = CliRunner().invoke(build(line), [*line, "--json"], catch_exceptions=False)
    assert Compensation.model_validate_json(again.output) == known


@pytest.mark.parametrize("text", [MAP, MAP.replace("drag_kgps: [0.3, 0.3, 0.6]", "")])
def test_a_frame_that_the_motion_contradicts_is_refused(tmp_path: Path, text: str) -> None:
    """Noise of a centimetre a second does not hide it; who insists is heard."""
    rng = np.random.default_rng(7)
    noisy = {n: COLUMNS[n] + 0.01 * rng.normal(size=len(COLUMNS["t"])) for n in ("vx", "vy", "vz")}
    other = text.replace("ENU", "NED")
    for columns in (COLUMNS, COLUMNS | noisy):
        with pytest.raises(UserError, match=r"with the frame NED .* write frame: ENU, or check_f"):
            found(tmp_path, columns, other)
        found(tmp_path, columns, text)
        found(tmp_path, columns, f"{other}check_frame: false\n")


def test_a_stray_quote_is_refused_with_its_line(tmp_path: Path) -> None:
    """It would open a cell that swallows all rows up to the next quote, or the end."""
    log = write(tmp_path / "flight.csv", COLUMNS)
    lines = log.read_text().splitlines()
    lines[5638] = lines[5638].replace(",", ',"', 1)
    log.write_text("\n".join(lines))
    with pytest.raises(UserError, match=r"flight.csv, line 5639: a quote opens a cell"):
        read(log)
    lines[9000] += '"'  # as far as there the rows would be one cell
    log.write_text("\n".join(lines))
    with pytest.raises(UserError, match=r"line 5639"):
        read(log)


def test_a_log_with_a_column_twice_is_a_mistake(tmp_path: Path) -> None:
    log = write(tmp_path / "flight.csv", COLUMNS)
    log.write_bytes(log.read_bytes().replace(b'"vy"', b'"vx"', 1))
    with pytest.raises(UserError, match="two columns are called 'vx'"):
        read(log)
