"""The ring's two curves as a drawing holds them: splines, arcs or straight lines."""

from collections.abc import Callable
from dataclasses import dataclass
from difflib import get_close_matches
from math import ceil, floor, log10
from typing import Literal, get_args

import numpy as np

from camring.exchange.drawings.ring import Ring
from camring.files.errors import InputError, quote
from camring.geometry.closed_chain import ChainError, ClosedChain, fit_chain
from camring.numerics.closed_spline import ClosedSpline

__all__ = ["DxfKind", "DxfStyle", "RingCurves", "micrometres", "ring_curves"]

DxfKind = Literal["spline", "polyline", "arcs"]

DEFAULT_TOLERANCE = 1e-6  # m, as for the chords of the point table
_TOLERANCES = (1e-8, 1e-4)  # m; below it no machine, above it no ring


@dataclass(frozen=True)
class DxfStyle:
    """How the curves of a DXF are written.

    Attributes
    ----------
    kind
        Splines in a drawing of release 2010; or, in one of release 12, which nearly every
        machine control reads, straight lines or arcs.
    tolerance
        How far those may stray from the exact curves, m.
    """

    kind: DxfKind = "spline"
    tolerance: float = DEFAULT_TOLERANCE

    @classmethod
    def of(cls, kind: str | None, tolerance: float | None) -> "DxfStyle":
        """The style asked for; None leaves the default.

        Raises
        ------
        InputError
            For another kind, for a tolerance of splines, and for one out of range.
        """
        kinds = get_args(DxfKind)
        if kind is not None and kind not in kinds:
            close = get_close_matches(kind, kinds, n=1, cutoff=0.4)
            hint = f" (did you mean {close[0]!r}?)" if close else ""
            raise InputError("--dxf", f"is {quote(kind)}{hint}", f"give one of {', '.join(kinds)}")
        chosen: DxfKind = next((each for each in kinds if each == kind), "spline")
        if tolerance is None:
            return cls(chosen)
        if chosen == "spline":
            raise InputError(
                "--dxf-tolerance",
                "has no effect on splines, which stray at most 0.1 um",
                "leave it away, or add --dxf polyline or --dxf arcs",
            )
        least, most = _TOLERANCES
        if not least <= tolerance <= most:
            raise InputError(
                "--dxf-tolerance",
                f"is {1e6 * tolerance:g} um but must be from {1e6 * least:g} to {1e6 * most:g} um",
                'give a length such as "2 um"',
            )
        return cls(chosen, tolerance)

    @property
    def is_release_12(self) -> bool:
        return self.kind != "spline"


@dataclass(frozen=True, eq=False)
class RingCurves:
    """Both curves in one style."""

    style: DxfStyle
    pitch: ClosedSpline | ClosedChain
    surface: ClosedSpline | ClosedChain

    @property
    def error(self) -> float:
        """Largest distance of either from its exact curve, along the normal, m."""
        return max(self.pitch.error, self.surface.error)

    @property
    def counts(self) -> dict[str, float]:
        """Pieces of the spline of the surface, or links of both chains."""
        if isinstance(self.pitch, ClosedSpline) or isinstance(self.surface, ClosedSpline):
            assert isinstance(self.surface, ClosedSpline)
            return {"pieces": float(self.surface.pieces)}
        return {
            "tolerance": self.style.tolerance,
            "pitch_curve_segments": float(self.pitch.links),
            "working_surface_segments": float(self.surface.links),
        }

    @property
    def each(self) -> str:
        """What each curve is, in words."""
        if isinstance(self.pitch, ClosedSpline) or isinstance(self.surface, ClosedSpline):
            return "one closed cubic spline"
        kind = "arcs without corners" if self.style.kind == "arcs" else "straight lines"
        return (
            f"one closed polyline of {kind} ({self.pitch.links} in the pitch curve, "
            f"{self.surface.links} in the working surface)"
        )


def ring_curves(ring: Ring, style: DxfStyle) -> RingCurves:
    """The ring's curves in a style; chains are fitted to the exact curves, not to the splines.

    Raises
    ------
    InputError
        When no chain of a sensible number of links keeps the tolerance.
    """
    if style.kind == "spline":
        return RingCurves(style, ring.pitch, ring.surface)
    return RingCurves(style, _chain(ring, 0.0, style), _chain(ring, ring.roller_radius, style))


def _chain(ring: Ring, distance: float, style: DxfStyle) -> ClosedChain:
    def stray(point: np.ndarray, near: np.ndarray) -> np.ndarray:
        return ring.outline.stray(point, near, distance)

    kind: Literal["lines", "arcs"] = "arcs" if style.kind == "arcs" else "lines"
    try:
        return fit_chain(_follow(ring, distance), stray, ring.repeats, style.tolerance, kind)
    except ChainError as error:
        raise InputError(
            "--dxf-tolerance",
            f"is {1e6 * style.tolerance:g} um, but {error.links} {kind} still stray "
            f"{1e6 * error.strays:.3g} um",
            "give a larger one, or take the spline",
        ) from error


def _follow(
    ring: Ring, distance: float
) -> Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]:
    def follow(parameter: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        found = ring.outline.places(parameter, distance)
        return found.point, found.normal, found.curvature

    return follow


def micrometres(length: float) -> str:
    """A length (m) in micrometres with two digits, rounded up: no file claims too little."""
    if length <= 0:
        return "0 um"
    grain = 10.0 ** (floor(log10(1e6 * length)) - 1)
    return f"{ceil(1e6 * length / grain - 1e-9) * grain:.2g} um"
