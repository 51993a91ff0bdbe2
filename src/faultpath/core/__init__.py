"""The ground of all rooms: errors and whose they are, arrays, streams, readers of files."""
