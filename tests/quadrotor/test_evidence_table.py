"""Evidence as data: keys, names, and a table that comes back from its file as it went."""

import numpy as np
import pytest
from faultpath_quadrotor.evidence.table import (
    EvidenceTable,
    Measured,
    Measurement,
    Recording,
    read_evidence,
    write_evidence,
)

from faultpath.core.errors import UserError
from faultpath.core.streams import generator

RECORDING = Recording(library="held-out", variant="gru", options={"wind": "L3"})


def asked(**changes) -> Measurement:
    given = {"recording": RECORDING, "quantity": "acceleration-error", "subject": "dob"}
    return Measurement(**(given | changes))


def found(count=30, seed=0) -> Measured:
    values = generator("test-evidence", "table", seed).random(count).astype(np.float32)
    return Measured(
        scenes=tuple(f"held-out/{i // 10:03d}" for i in range(count)),
        steps=12 + 5 * (np.arange(count) % 10),
        values=values.astype(np.float64),
    )


def test_a_table_comes_back_as_it_went_with_the_same_bytes(tmp_path):
    table = EvidenceTable(
        {asked(): found(), asked(faults=("calibration=+0.1@predictor",)): found(seed=1)}
    )
    path = tmp_path / "evidence.parquet"
    write_evidence(path, table)
    back = read_evidence(path)
    assert list(back) == list(table)
    for measurement in table:
        one, two = table.values(measurement), back.values(measurement)
        assert one.same_windows(two)
        assert np.array_equal(one.values, two.values)
    write_evidence(tmp_path / "again.parquet", back)
    assert (tmp_path / "again.parquet").read_bytes() == path.read_bytes()
    with pytest.raises(KeyError):
        back.values(asked(seed=2))


def test_a_missing_or_damaged_table_is_the_user_s_to_see(tmp_path):
    with pytest.raises(UserError, match="cannot read"):
        read_evidence(tmp_path / "none.parquet")
    (tmp_path / "odd.parquet").write_bytes(b"odd")
    with pytest.raises(UserError, match="damaged"):
        read_evidence(tmp_path / "odd.parquet")
