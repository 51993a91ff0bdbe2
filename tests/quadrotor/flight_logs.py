"""A made-up flight whose physics are known, and the files that it may lie in."""

import struct
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.csv as csv
import pyarrow.parquet as pq
from scipy.spatial.transform import Rotation

G, RATE_HZ, MASS_KG, DRAG = 9.80665, 200, 1.5, (0.3, 0.3, 0.6)

MAP = """
time: {column: t, unit: s}
attitude: {columns: [qw, qx, qy, qz], order: wxyz}
velocity: {columns: [vx, vy, vz]}
thrust: {column: thrust}
frame: ENU
mass_kg: 1.5
drag_kgps: [0.3, 0.3, 0.6]
"""


def flown(seconds: float = 60.0, wind: float = 3.0, seed: int = 0) -> dict[str, Any]:
    """Return the columns of a flight: z up, thrust in N, wind that changes within seconds."""
    rng = np.random.default_rng(seed)
    n = int(seconds * RATE_HZ)
    t = np.arange(n) / RATE_HZ
    phase = rng.uniform(0, 2 * np.pi, 8)
    roll, pitch = 0.2 * np.sin(0.9 * t + phase[0]), 0.2 * np.sin(1.3 * t + phase[1])
    rotation = Rotation.from_euler("ZYX", np.stack([0.3 * t, pitch, roll], axis=1))
    thrust = MASS_KG * G / np.cos(roll) / np.cos(pitch) * (1 + 0.05 * np.sin(2.1 * t + phase[2]))
    blown = wind * np.stack([np.sin(0.5 * t + phase[3]), np.cos(0.4 * t), np.sin(0.7 * t)], axis=1)
    axis, turned = rotation.apply([0.0, 0.0, 1.0]), rotation.as_matrix()
    velocity = np.zeros((n, 3))
    for i in range(n - 1):
        against = (velocity[i] - blown[i]) @ turned[i]
        force = axis[i] * thrust[i] - turned[i] @ (np.array(DRAG) * against)
        velocity[i + 1] = velocity[i] + (force / MASS_KG - [0, 0, G]) / RATE_HZ
    x, y, z, w = rotation.as_quat().T
    names = ("t", "qw", "qx", "qy", "qz", "vx", "vy", "vz", "thrust")
    return dict(zip(names, (t, w, x, y, z, *velocity.T, thrust), strict=True))


def map_file(folder: Path, text: str = MAP) -> str:
    path = folder / "map.yaml"
    path.write_text(text)
    return str(path)


def read(log: Path, text: str = MAP) -> Any:
    """Read a log by a map beside it; who only writes logs needs no quadrotor."""
    from faultpath_quadrotor.flightlog.flight import read_flight
    from faultpath_quadrotor.flightlog.reading import read_columns

    return read_flight(log, read_columns(map_file(log.parent, text)))


def write(path: Path, columns: dict[str, Any]) -> Path:
    table = pa.table(columns)
    if path.suffix == ".parquet":
        pq.write_table(table, path)
    else:
        csv.write_csv(table, path)
    return path


def write_ulog(
    path: Path,
    columns: dict[str, Any],
    full_n: float = 30.0,
    quiet: dict[str, tuple[float, float]] | None = None,
) -> Path:
    """Write the three messages of PX4's ULog format that the shipped map reads.

    `quiet` says from when to when a message is not sent, s.
    """
    w, x, y, z = (columns[name] for name in ("qw", "qx", "qy", "qz"))
    v = np.stack([columns["vx"], -columns["vy"], -columns["vz"]], axis=1)
    messages = {
        "vehicle_attitude": ("float[4] q", np.stack([w, x, -y, -z], axis=1)),
        "vehicle_local_position": ("float vx;float vy;float vz", v),
        "vehicle_thrust_setpoint": (
            "float[3] xyz",
            np.stack([0 * w, 0 * w, -columns["thrust"] / full_n], axis=1),
        ),
    }
    out = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0)

    def put(kind: str, body: bytes) -> bytes:
        return struct.pack("<HB", len(body), ord(kind)) + body

    out += put("B", bytes(40))
    for name, (fields, _) in messages.items():
        out += put("F", f"{name}:uint64_t timestamp;{fields};".encode())
    for index, name in enumerate(messages):
        out += put("A", struct.pack("<BH", 0, index) + name.encode())
    stamps = np.round(columns["t"] * 1e6).astype(np.uint64)
    for row, stamp in enumerate(stamps):
        for index, (name, (_, values)) in enumerate(messages.items()):
            begins, ends = (quiet or {}).get(name, (0.0, 0.0))
            if begins < columns["t"][row] < ends:
                continue
            body = struct.pack("<HQ", index, int(stamp)) + values[row].astype("<f4").tobytes()
            out += put("D", body)
    path.write_bytes(out)
    return path
