"""Reports from results and outcome tables: one HTML page, Markdown and the terminal."""
