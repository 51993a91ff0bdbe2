"""Reports from records and outcome tables: one HTML page, Markdown and the terminal."""
