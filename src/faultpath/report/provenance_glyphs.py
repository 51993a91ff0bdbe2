"""Small signs for provenance and gaps, so that neither is told by colour alone."""

from faultpath.interface import Gap, Provenance
from faultpath.report.svg import Svg


def draw_provenance(svg: Svg, provenance: Provenance, x: float, y: float) -> None:
    """Draw the sign of a provenance, about 14 pixels wide, around `(x, y)`."""
    match provenance:
        case Provenance.MEASURED:
            svg.circle((x, y), 5, "glyph solid")
        case Provenance.ESTIMATED:
            svg.circle((x, y), 5, "glyph")
            svg.path(f"M{x} {y - 5}a5 5 0 0 0 0 10z", "glyph solid")
        case Provenance.RECONSTRUCTED:
            svg.path(f"M{x + 4.2} {y - 3.6}a5.5 5.5 0 1 0 1.2 4.6", "glyph")
            svg.path(f"M{x + 4.6} {y - 7.4}v4.2h-4.2z", "glyph solid")
        case Provenance.PRIVILEGED:
            svg.rect(x - 5, y - 1.5, 10, 7.5, "glyph solid", 1)
            svg.path(f"M{x - 3} {y - 1.5}v-2a3 3 0 0 1 6 0v2", "glyph")
        case Provenance.INTERNAL:
            svg.rect(x - 5, y - 5, 10, 10, "glyph", 1)
            svg.circle((x, y), 2, "glyph solid")
        case Provenance.CONSTANT:
            svg.path(f"M{x - 5} {y - 2.5}h10M{x - 5} {y + 2.5}h10", "glyph")
        case Provenance.COMMANDED:
            svg.polygon([(x - 4, y - 5), (x + 5.5, y), (x - 4, y + 5)], "glyph solid")


def draw_gap(svg: Svg, gap: Gap, x: float, y: float) -> None:
    """Draw the sign of a gap: a wave for fidelity, an interrupted line for availability."""
    match gap:
        case Gap.NONE:
            svg.path(f"M{x - 6} {y}h12", "glyph")
        case Gap.FIDELITY:
            svg.path(f"M{x - 6} {y + 1}q3 -7 6 -1t6 -1", "glyph")
        case Gap.AVAILABILITY:
            svg.path(f"M{x - 7} {y}h4M{x + 3} {y}h4", "glyph")
            svg.path(f"M{x - 2.5} {y - 4}v8M{x + 2.5} {y - 4}v8", "glyph")
