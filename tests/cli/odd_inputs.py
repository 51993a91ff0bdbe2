"""Inputs that are wrong in every way a seed draws: values, keys, texts, bytes, tables, folders."""

import hashlib
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

VALUES: tuple[Any, ...] = (
    *(None, True, False, 0, 1, -1, 2, 0.5, -0.0, 1e308, -1e308, 5e-324, 1e-13, 2**63, 10**18),
    *("", " ", "0", "-1", "nan", "inf", "1_0", "٣", "true", "1e999", "../../x", "/dev/null", "."),
    *("a\u2028b", "a\x85b", "\u202egnp", "日本", "\x1b[31mred", "<b>", "[red]", "{0}", "%s", "\0"),
    *("\ud800", "x" * 3000, "success", "failed", "shared", "old", "controller", "gain:scale=1e308"),
    *([], {}, [1], [[]], [None] * 3, [1e308] * 3, {"0": True}, {"value": 1}, {"": ""}, ["a", "a"]),
)
RECORDS = ("record.json", "map.json", "search.json", "sensitivity.json")
TEXTS = ("", " ", "nan", '"', "'", "{", "}", "[", "\t", "\r", "\0", "\ufeff", "\u2028", "\x85", ",")


def places(content: Any, at: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yield the path of everything below a value."""
    items = content.items() if isinstance(content, dict) else enumerate(content)
    for key, value in items:
        yield (*at, key)
        if isinstance(value, dict | list):
            yield from places(value, (*at, key))


def altered(content: Any, rng: Random) -> Any:
    """Return JSON data with one part altered: replaced, left out, twice, renamed, wrapped."""
    every = list(places(content))
    if not every:
        return rng.choice(VALUES)
    *way, key = rng.choice(every)
    holder = content
    for part in way:
        holder = holder[part]
    value = holder[key]
    if rng.random() < 0.5 and isinstance(value, str | int | float):  # of the same type
        kinds = (bool,) if isinstance(value, bool) else (str,) if isinstance(value, str) else ()
        others = [each for each in VALUES if type(each) in (kinds or (int, float))]
        others += [each for each in _leaves(content) if type(each) is type(value)]
        holder[key] = rng.choice(others)
        return content
    match rng.randrange(9):
        case 0 if isinstance(holder, dict):
            del holder[key]
        case 1 if isinstance(holder, dict):
            holder[rng.choice(("", "0", "odd", f"{key} ", str(key).upper()))] = holder.pop(key)
        case 2 if isinstance(holder, list):
            holder.insert(0, value)
        case 3 if isinstance(holder, list):
            del holder[key]
        case 4:
            holder[key] = rng.choice(([value], {"a": value}, [value, value]))
        case 5 if isinstance(value, int | float):
            holder[key] = rng.choice((-value, value + 1, value * 1e300, value * 1e-300, str(value)))
        case 6 if isinstance(value, list | dict) and value:
            holder[key] = type(value)()
        case _:
            holder[key] = rng.choice(VALUES)
    return content


def _leaves(content: Any) -> Iterator[Any]:
    for way in places(content):
        value = content
        for part in way:
            value = value[part]
        if not isinstance(value, dict | list):
            yield value


def torn(data: bytes, rng: Random) -> bytes:
    """Return bytes that are cut, flipped, doubled or overwritten somewhere."""
    at = rng.randrange(len(data) + 1)
    match rng.randrange(6):
        case 0:
            return data[:at]
        case 1:
            return data[:at] + rng.randbytes(rng.choice((1, 3, 40))) + data[at:]
        case 2:
            return data[:at] + bytes(b ^ 255 for b in data[at : at + 4]) + data[at + 4 :]
        case 3:
            return data[:at] + bytes(200) + data[at + 200 :]
        case 4:
            return data + data
        case _:
            return data[at:]


def misspelt(text: str, rng: Random) -> str:
    """Return text with a few characters too many, a line twice, or a line gone."""
    lines = text.split("\n")
    at = rng.randrange(len(lines))
    match rng.randrange(4):
        case 0:
            lines.insert(at, lines[at])
        case 1:
            del lines[at]
        case 2:
            line = lines[at]
            place = rng.randrange(len(line) + 1)
            lines[at] = line[:place] + rng.choice(TEXTS) + line[place:]
        case _:
            return "".join(lines[:at]) + rng.choice(TEXTS) * rng.choice((1, 3)) + "\n".join(lines)
    return "\n".join(lines)


def json_text(content: Any, rng: Random) -> bytes:
    """Return JSON of altered data, now and then with a key twice, no number, or deep nesting."""
    text = json.dumps(altered(json.loads(json.dumps(content)), rng))
    match rng.randrange(24):
        case 0:
            text = text.replace("{", '{"format": 1, "format": 2, ', 1)
        case 1:
            text = text.replace("0", rng.choice(("NaN", "Infinity", "1e999", "9" * 5000)), 1)
        case 2:
            text = text.replace("0", "[" * 3000 + "]" * 3000, 1)
        case 3:
            return torn(text.encode(), rng)
        case 4:
            return misspelt(text, rng).encode("utf-8", "surrogatepass")
    return text.encode()


def table_bytes(table: pa.Table, path: Path, rng: Random) -> bytes:
    """Return a Parquet file of an altered table: a cell, a column, its type, or the rows."""
    name = rng.choice(table.column_names)
    place = table.column_names.index(name)
    values: list[Any] = table[name].to_pylist()
    kind: pa.DataType = table[name].type
    match rng.randrange(8):
        case 0:
            table = table.drop_columns([name])
        case 1:
            table = table.rename_columns([f"{n}x" if n == name else n for n in table.column_names])
        case 2:
            table = table.slice(0, rng.randrange(table.num_rows + 1))
        case 3:
            table = pa.concat_tables([table, table])
        case 4:
            table = table.set_column(place, name, pa.array([str(v) for v in values]))
        case 5:
            table = table.append_column(name, table[name])
        case _:
            odd = {pa.string(): ("", "odd", "\u2028", "<b>", "x" * 3000), pa.int64(): (-1, 2**62)}
            numbers = (None, float("nan"), float("inf"), -1.0, 1e308, 5e-324)
            listed = ([], None, [float("nan")], [1e38] * 3)
            choices = odd.get(kind, listed if pa.types.is_list(kind) else numbers)
            for at in rng.sample(range(len(values)), min(len(values), rng.choice((1, 5)))):
                values[at] = rng.choice(choices)
            table = table.set_column(place, name, pa.array(values, kind))
    pq.write_table(table, path)
    return path.read_bytes()


def alter_folder(folder: Path, rng: Random) -> None:
    """Alter a file or two of a run folder, and mostly give provenance.json the new digests."""
    names = sorted(each.name for each in folder.iterdir() if each.suffix in (".json", ".parquet"))
    records = [name for name in names if name in RECORDS]
    few = rng.sample(names, rng.choice((1, 1, 1, 2)))
    for name in few if rng.random() < 0.5 else records:
        path = folder / name
        data = path.read_bytes()
        if rng.random() < 0.1:
            path.write_bytes(torn(data, rng))
        elif path.suffix == ".json":
            path.write_bytes(json_text(json.loads(data), rng))
        else:
            table_bytes(pq.read_table(path), path, rng)
    if rng.random() < 0.9:
        sign(folder)


def sign(folder: Path) -> None:
    """Give provenance.json the digests of the files as they are, as a forger would."""
    path = folder / "provenance.json"
    try:
        content = json.loads(path.read_bytes())
        for name in content["files"]:
            digest = hashlib.sha256((folder / name).read_bytes()).hexdigest()
            content["files"][name] = digest
            if name == "outcomes.parquet":
                content["outcomes_sha256"] = digest
        path.write_text(json.dumps(content))
    except (ValueError, LookupError, TypeError, AttributeError, OSError):
        return  # it is what was altered


def lines_of(content: list[Any], rng: Random) -> bytes:
    """Return JSON lines, one of them altered."""
    at = rng.randrange(len(content))
    texts = [json.dumps(each).encode() for each in content]
    texts[at] = json_text(content[at], rng)
    return b"\n".join(texts)


def cells_of(text: str, rng: Random) -> bytes:
    """Return CSV with odd cells, or an odd text."""
    rows = [line.split(",") for line in text.splitlines()]
    row = rng.choice(rows)
    odd = rng.choice(VALUES)
    if rng.random() < 0.6:
        column = rng.randrange(len(row))
        for each in rng.choice(([row], rows, rows[1:])):
            each[column] = str(odd)
        text = "\n".join(map(",".join, rows)) + "\n"
    else:
        text = misspelt(text, rng)
    data = text.encode("utf-8", "surrogatepass")
    return torn(data, rng) if rng.random() < 0.15 else data


Case = Callable[[Path, Random], list[object]]
"""Puts files into a folder and returns the line of a command."""
