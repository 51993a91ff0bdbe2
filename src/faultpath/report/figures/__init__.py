"""Pictures as pure functions: data in, SVG markup out."""
