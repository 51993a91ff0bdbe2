"""Wrong inputs in great numbers: one sentence and status 2, never a traceback, never a hang, and
nothing written outside. `make fuzz` draws others; SEED repeats the seed that a failure names."""

import json
import os
import random
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import typer
from cli_runs import ROOT, TOY, audit
from fuzz_inputs import (
    JUNK,
    STEERING,
    VERBS,
    commands,
    documents,
    flags,
    leaves,
    texts,
    wrong,
)

from faultpath import plan
from faultpath.cli.app import build
from faultpath.errors import UserError
from faultpath.interface import interface_yaml, read_interface
from faultpath.proposal.study import read_study

pytestmark = pytest.mark.fuzz
CHUNKS, EACH = 4, 70


MUTE = """
class Mute(Exception):
    def __str__(self):
        raise RuntimeError("no words")
    __repr__ = __str__
def create():
    raise Mute
"""
NAMED = """
import sys
sys.path.insert(0, {examples!r})
from toy import *
from faultpath.trials import Metric
class Named(Toy):
    name = {name!r}
    ends = {{Status.TIMEOUT: {end!r}}}
    distance = Metric(unit={unit!r}, better="less", words={words!r}, title={title!r})
    metrics = {{"terminal_distance_m": distance}}
    wirings = {{"calibrated": Wiring({first!r}), {variant!r}: Wiring({second!r})}}
    def library(self, name):
        scenes = (SceneRef(f"{{i}}" + {scene!r}, i, {kind!r}) for i in range(4))
        return Library(name, tuple(scenes), "h")
    def run(self, variant, scenes, taps, seed):
        if {fails} and seed:
            raise ValueError({said!r})
        return super().run(variant, scenes, taps, seed)
def create():
    print({printed!r})
    return Named()
"""
NAMES = ("name", "end", "unit", "words", "title", "first", "second", "variant", "scene", "kind")


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working directory with things in it that are not what their names say."""
    place = tmp_path / "here"
    (place / "folder").mkdir(parents=True)
    (place / "folder.py").mkdir()
    (place / "text.txt").write_text("text\n")
    (place / "mine.json").write_text("{}")
    (place / "broken.py").write_text("def create():\n    return 1 / 0\n")
    (place / "mute.py").write_text(MUTE)
    for name in ("binary", "binary.py"):
        (place / name).write_bytes(random.Random(0).randbytes(400))
    (place / "loop").symlink_to("loop")
    monkeypatch.chdir(place)
    monkeypatch.setenv("CUDA_VISIBLE_DEVICES", "")
    return place


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("fuzz") / "run"
    assert audit(out=folder, scenes=2).status == 0
    return folder


def test_no_verb_is_left_out() -> None:
    verbs = dict(leaves(typer.main.get_command(build())))
    assert set(VERBS) == set(verbs)
    for verb, (_, options) in VERBS.items():
        assert set(options) <= set(flags(verbs[verb])), verb


@pytest.mark.parametrize("draw", range(2))
def test_names_and_messages_of_a_system(draw: int, here: Path, fuzz_seed: int) -> None:
    rng = random.Random(f"{fuzz_seed} {draw}")
    odd = set(rng.sample(NAMES, rng.randint(1, 3)))
    given = {each: each + (rng.choice(STEERING) if each in odd else "") for each in NAMES}
    more = {"said": "".join(STEERING), "printed": "".join(STEERING), "fails": draw % 2}
    text = NAMED.format(examples=str(ROOT / "examples"), **given, **more)
    (here / "named.py").write_text(text)
    asked = ["--baseline", "calibrated", "--repair", given["variant"], "--fault", "gain:scale=0.6"]
    lines = (
        ["trace", "named.py:create"],
        ["audit", "named.py:create", *asked, "--seeds", "0,1", "--workers", "0", "--out", "r"],
    )
    found = [fault for line in lines if (fault := wrong(line, here, prints=True))]
    assert not found, "\n".join((f"seed {fuzz_seed}", *found))


@pytest.mark.parametrize("chunk", range(CHUNKS))
def test_every_command(chunk: int, here: Path, fuzz_seed: int) -> None:
    lines = list(commands(fuzz_seed * CHUNKS + chunk, EACH))
    assert len(lines) * CHUNKS >= 250
    found = [fault for line in lines if (fault := wrong(line, here))]
    assert not found, "\n".join((f"seed {fuzz_seed}", *found))


def test_junk_in_the_place_of_every_word(here: Path, fuzz_seed: int) -> None:
    lines = [[junk] for junk in JUNK] + [["report", junk] for junk in JUNK]
    found = [fault for line in lines if (fault := wrong(line, here))]
    assert not found, "\n".join((f"seed {fuzz_seed}", *found))


def test_interface_texts(fuzz_seed: int) -> None:
    rng = random.Random(fuzz_seed)
    sys.path.append(str(ROOT / "examples"))
    try:
        from toy import Toy
    finally:
        sys.path.remove(str(ROOT / "examples"))
    read = 0
    for text in texts(rng, interface_yaml(Toy.interface), 300):
        try:
            interface = read_interface(text + "\n")
        except UserError as refused:
            said = str(refused)
        except Exception as error:
            raise AssertionError(f"seed {fuzz_seed}: {error!r} for {text!r}") from error
        else:
            read, said = read + 1, ""
            assert read_interface(interface_yaml(interface)) == interface, (fuzz_seed, text)
        assert "\n" not in said, (fuzz_seed, text)
    assert 0 < read < 290


def test_study_texts(here: Path, fuzz_seed: int) -> None:
    rng = random.Random(fuzz_seed)
    given = {"faults": "gain:scale=0.6", "library": "carts", "scenes": 2}
    made = plan(TOY, baseline="calibrated", repair="blind", progress=False, **given)
    read = 0
    for text in texts(rng, made.plan.study.yaml(), 300):
        path = here / "study.yaml"
        path.write_bytes(text.encode("utf-8", "surrogatepass"))
        try:
            read_study(path)
        except UserError:
            continue
        except Exception as error:
            raise AssertionError(f"seed {fuzz_seed}: {error!r} for {text!r}") from error
        read += 1
    assert 0 < read < 290


def test_run_folders(run: Path, here: Path, fuzz_seed: int) -> None:
    rng = random.Random(fuzz_seed)
    names = sorted(str(path.relative_to(run)) for path in run.rglob("*") if path.is_file())
    found: list[str] = []
    for number in range(60):
        folder = here / f"run{number}"
        shutil.copytree(run, folder)
        target = folder / rng.choice([name for name in names if not name.startswith(".")])
        data = target.read_bytes()
        if target.suffix == ".json" and rng.random() < 0.7:
            (text,) = documents(rng, json.loads(data), 1)
            target.write_text(text, errors="surrogatepass")
        else:
            target.unlink()
            kind = rng.randrange(4)
            if kind == 0:
                target.mkdir()
            elif kind == 1:
                os.mkfifo(target)
            elif kind == 2:
                at = rng.randrange(max(1, len(data)))
                target.write_bytes(data[:at] + rng.randbytes(3) + data[at + 3 :])
        if fault := wrong(["report", folder.name], here):
            found.append(f"{target.relative_to(folder)}: {fault}")
        shutil.rmtree(folder)
    assert not found, "\n".join((f"seed {fuzz_seed}", *found))


@pytest.mark.parametrize(
    "line",
    [["audit", "\udcff"], ["report", "x" * 5000], ["trace", "broken.py:create"]],
    ids=str,
)
def test_in_a_process_of_its_own(line: list[str], here: Path) -> None:
    code = "from faultpath.cli.main import main; main()"
    done = subprocess.run([sys.executable, "-c", code, *line], capture_output=True, timeout=60)
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    assert done.stderr.startswith(b"faultpath: ")
