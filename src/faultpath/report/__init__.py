"""Reports from records and outcome tables: one HTML page, LaTeX, Markdown and the terminal."""
