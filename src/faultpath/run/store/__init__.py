"""Files of a run: a folder of shards, and the tables assembled from them."""
