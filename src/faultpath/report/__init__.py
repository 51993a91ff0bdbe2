"""Results in words, tables and pictures: as pages, Markdown, XML and on the terminal."""
