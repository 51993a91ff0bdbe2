"""What every room stands on: errors and whose they are, arrays, streams, readers of files."""
