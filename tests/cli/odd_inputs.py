"""Inputs that are wrong in every way a seed draws: values, keys, texts, bytes, tables, folders."""

import hashlib
import json
from collections.abc import Iterator
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
RECORDS = ("record.json", "map.json")
TEXTS = ("", " ", "nan", '"', "'", "{", "}", "[", "\t", "\r", "\0", "\ufeff", "\u2028", "\x85", ",")


def places(content: Any, at: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yield the path of everything below a value."""
    items = content.items() if isinstance(content, dict) else enumerate(content)
    for key, value in items:
        yield (*at, key)
        if isinstance(value, dict | list):
            yield from places(value, (*at, key))


def altered(content: Any, rng: Random) -> Any:
    """Return JSON data with one part replaced, left out, twice, renamed or wrapped."""
    every = list(places(content))
    if not every:
        return rng.choice(VALUES)
    *way, key = rng.choice(every)
    holder = content
    for part in way:
        holder = holder[part]
    value, chance = holder[key], rng.random()
    if isinstance(holder, dict) and chance < 0.2:
        del holder[key]
        if chance < 0.1:
            holder[rng.choice(("", "0", "odd", f"{key} ", str(key).upper()))] = value
    elif isinstance(holder, list) and chance < 0.2:
        holder[key : key + 1] = rng.choice(([], [value, value]))
    elif isinstance(value, int | float) and chance < 0.4:
        holder[key] = rng.choice((-value, value + 1, value * 1e300, value * 1e-300, str(value)))
    else:
        same = [other for other in VALUES if type(other) is type(value)]
        holder[key] = rng.choice((*same, rng.choice(VALUES), [value], {"a": value}))
    return content


def torn(data: bytes, rng: Random) -> bytes:
    """Return bytes of which a part is cut, blank, doubled or noise."""
    start, end = sorted(rng.randrange(len(data) + 1) for _ in range(2))
    part = rng.choice((b"", bytes(end - start), data[start:end] * 2, rng.randbytes(3)))
    return data[:start] + part + data[end:]


def misspelt(text: str, rng: Random) -> str:
    """Return text with a few characters too many, a line twice, or a line gone."""
    lines = text.split("\n")
    at = rng.randrange(len(lines))
    place = rng.randrange(len(lines[at]) + 1)
    line = lines[at][:place] + rng.choice(TEXTS) + lines[at][place:]
    lines[at : at + 1] = rng.choice(([], [lines[at]] * 2, [line]))
    return "\n".join(lines)


def json_text(content: Any, rng: Random) -> bytes:
    text, chance = json.dumps(altered(json.loads(json.dumps(content)), rng)), rng.random()
    if chance < 0.05:
        return torn(text.encode(), rng)
    return (misspelt(text, rng) if chance < 0.1 else text).encode("utf-8", "surrogatepass")


def alter_table(path: Path, rng: Random) -> None:
    """Alter a Parquet file: a cell, a column, its type, or the rows."""
    table = pq.read_table(path)
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
        case _ if values:
            odd = {pa.string(): ("", "odd", "\u2028", "<b>", "x" * 3000), pa.int64(): (-1, 2**62)}
            numbers = (None, float("nan"), float("inf"), -1.0, 1e308, 5e-324)
            listed = ([], None, [float("nan")], [1e38] * 3)
            values[rng.randrange(len(values))] = rng.choice(
                odd.get(kind, listed if pa.types.is_list(kind) else numbers)
            )
            table = table.set_column(place, name, pa.array(values, kind))
    pq.write_table(table, path)


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
            alter_table(path, rng)
    if rng.random() < 0.9:
        sign(folder)


def sign(folder: Path) -> None:
    """Give provenance.json the digests of the files as they are, as a forger would."""
    path = folder / "provenance.json"
    try:
        content = json.loads(path.read_bytes())
        for name in content["files"]:
            content["files"][name] = hashlib.sha256((folder / name).read_bytes()).hexdigest()
        path.write_text(json.dumps(content))
    except (ValueError, LookupError, TypeError, AttributeError, OSError):
        return  # it is what was altered


def lines_of(content: list[Any], rng: Random) -> bytes:
    """Return JSON lines, one of them altered."""
    at = rng.randrange(len(content))
    texts = [json.dumps(entry).encode() for entry in content]
    return b"\n".join([*texts[:at], json_text(content[at], rng), *texts[at + 1 :]])


def cells_of(text: str, rng: Random) -> bytes:
    """Return CSV with odd cells, or an odd text."""
    rows = [line.split(",") for line in text.splitlines()]
    if rng.random() < 0.6:
        odd, column = str(rng.choice(VALUES)), rng.randrange(len(rows[0]))
        for row in rng.choice(([rng.choice(rows)], rows, rows[1:])):
            row[column] = odd
        text = "\n".join(map(",".join, rows)) + "\n"
    else:
        text = misspelt(text, rng)
    data = text.encode("utf-8", "surrogatepass")
    return torn(data, rng) if rng.random() < 0.15 else data
