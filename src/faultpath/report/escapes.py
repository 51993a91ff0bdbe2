"""Text as LaTeX and Markdown print it."""

_MARKDOWN = str.maketrans(
    {c: f"\\{c}" for c in r"\`*_[]|#"} | {"<": "&lt;", ">": "&gt;", "\n": " ", "\r": " "}
)

_LATEX = str.maketrans(
    {
        "\\": r"\textbackslash{}",
        "&": r"\&",
        "%": r"\%",
        "$": r"\$",
        "#": r"\#",
        "_": r"\_",
        "{": r"\{",
        "}": r"\}",
        "~": r"\textasciitilde{}",
        "^": r"\textasciicircum{}",
        "<": r"\textless{}",
        ">": r"\textgreater{}",
        "*": r"$^\star$",
        "−": "$-$",
        "–": "--",
        "Δ": r"$\Delta$",
        "²": "$^2$",
        "\n": " ",
        "\r": " ",
    }
)


def markdown(text: str) -> str:
    """Return text that Markdown shows as it is."""
    return text.translate(_MARKDOWN)


def latex(text: str) -> str:
    """Return text that LaTeX prints as it is; what an old pdflatex has no glyph for, by number."""
    marked = text.replace("p*", "\0").translate(_LATEX).replace("\0", r"$p^\star$")
    return "".join(c if ord(c) < 0x250 else f"[U+{ord(c):04X}]" for c in marked)
