"""What a run leaves behind: a folder of shards, and the tables assembled from them."""

# pyright: reportUnusedImport=false
from faultpath.trials.store.atomic import check_writable, make_folder, write_text
from faultpath.trials.store.folder import FORMAT, Manifest, RunFolder, read_outcomes
from faultpath.trials.store.parquet import read_table
from faultpath.trials.store.tables import Shard, TrialAddress, traces_of
