"""The ring's two curves as SVG in true size: one unit is one millimetre."""

import numpy as np

from camring.drawing.svg import escape
from camring.exchange.drawings.about import About
from camring.exchange.drawings.ring import Ring
from camring.numerics.closed_spline import ClosedSpline

__all__ = ["path_of", "ring_svg"]


def ring_svg(ring: Ring, about: About) -> bytes:
    """The SVG file; its curves are the very splines of the DXF, as Bezier pieces."""
    reach = 1.06 * 1e3 * ring.surface_outer
    size = 2 * reach
    text = " ".join(about.lines())
    arm = reach / 12
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{size:.4f}mm" height="{size:.4f}mm" '
        f'viewBox="{-reach:.4f} {-reach:.4f} {size:.4f} {size:.4f}">\n'
        f"<title>{escape(about.motor)}</title>\n"
        f"<desc>{escape(text)} Millimetres; y points up, so it is negative here.</desc>\n"
        f'<path id="WORKING_SURFACE" d="{path_of(ring.surface)}" fill="none" stroke="#000" '
        'stroke-width="0.35"/>\n'
        f'<path id="PITCH_CURVE" d="{path_of(ring.pitch)}" fill="none" stroke="#06c" '
        'stroke-width="0.18" stroke-dasharray="6 1 1 1"/>\n'
        f'<path id="CENTRE" d="M{-arm:.3f} 0H{arm:.3f}M0 {-arm:.3f}V{arm:.3f}" fill="none" '
        'stroke="#c00" stroke-width="0.13"/>\n'
        "</svg>\n"
    ).encode()


def path_of(curve: ClosedSpline, scale: float = 1.0, decimals: int = 6) -> str:
    """A closed curve as an SVG path in millimetres, y down; six decimals are nanometres."""
    pieces = 1e3 * scale * np.conj(curve.bezier())

    def written(point: complex) -> str:
        return f"{point.real:.{decimals}f} {point.imag:.{decimals}f}"

    bends = "".join(f"C{written(a)} {written(b)} {written(c)}" for a, b, c in pieces[:, 1:])
    return f"M{written(pieces[0, 0])}{bends}Z"
