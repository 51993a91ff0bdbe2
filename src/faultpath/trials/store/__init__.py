"""What a run leaves behind: a folder of shards, and the tables assembled from them."""
