"""Points of a ring as a file gave them, in order of their angle, and what part they cover."""

from dataclasses import dataclass, replace
from math import degrees, pi

import numpy as np
from jaxtyping import Complex, Float

from camring.files.errors import InputError

__all__ = ["PITCH", "SURFACE", "GivenCurve", "covered"]

PITCH, SURFACE = "pitch", "surface"
MOST_POINTS = 20_000
FEWEST_POINTS = 12
_SAME_ANGLE = 1e-9  # rad
_GAP = 5.0  # times the usual step
_WHOLE = 1.5  # steps by which a table may end before it would close


@dataclass(frozen=True, eq=False)
class GivenCurve:
    """Points of a ring.

    Attributes
    ----------
    shown
        The file's name, for messages.
    angles
        Polar angles in the file's order, rad, as they run on beyond a turn.
    radii
        Distance from the shaft, m.
    on
        `PITCH` for the path of the roller centre, `SURFACE` for the ring's working surface.
    places
        What a message calls each point: `line 12`, or nothing.
    sorted_by_us
        Whether the order of the points in the file means nothing, as in a drawing.
    guessed
        Whether nothing says which curve it is, and `on` is a guess.
    notes
        What was taken for granted, a sentence each.
    """

    shown: str
    angles: Float[np.ndarray, " point"]
    radii: Float[np.ndarray, " point"]
    on: str
    places: tuple[str, ...]
    sorted_by_us: bool = False
    guessed: bool = False
    notes: tuple[str, ...] = ()

    @property
    def points(self) -> Complex[np.ndarray, " point"]:
        """Points of the plane, m."""
        return self.radii * np.exp(1j * self.angles)

    def turned(self, angle: float) -> "GivenCurve":
        """The curve turned by an angle, rad."""
        return replace(self, angles=self.angles + angle)


def covered(curve: GivenCurve, pitch: float, tolerance: float) -> tuple[GivenCurve, float]:
    """The curve without the point that closes it, and the angle that it covers.

    Parameters
    ----------
    pitch
        Angle of one lobe, rad: a curve covers this or the whole ring.
    tolerance
        By how much the first and last point of a closed curve may differ, m.

    Returns
    -------
    curve, angle
        The angle is `pitch` or a full turn, rad.

    Raises
    ------
    InputError
        For too few points, two at one angle, points that go back, a gap, a part of a lobe.
    """
    _require_count(curve)
    curve = _forwards(curve)
    _require_order(curve)
    steps = np.diff(curve.angles)
    extent = float(curve.angles[-1] - curve.angles[0])
    usual = float(np.median(steps))
    reach = _WHOLE * float(np.max(steps))
    for period in (2 * pi, pitch):
        if abs(extent - period) < max(1e-5 * period, 0.01 * usual):
            curve = _without_last(curve, tolerance)
            break
        if period - reach <= extent < period:
            break
    else:
        raise InputError(
            curve.shown,
            f"covers {degrees(extent):.4g} deg, neither a lobe of {degrees(pitch):.4g} deg nor "
            "the ring of 360 deg",
            "give the points of one lobe or of the whole ring; a unit in the header may be the "
            "wrong one",
        )
    _require_no_gap(curve, usual)
    return curve, period


def _require_count(curve: GivenCurve) -> None:
    count = len(curve.angles)
    if not FEWEST_POINTS <= count <= MOST_POINTS:
        limit = f"at least {FEWEST_POINTS}" if count < FEWEST_POINTS else f"at most {MOST_POINTS:,}"
        raise InputError(
            curve.shown,
            f"has {count:,} points where a cam takes {limit}",
            "give a point every degree or half" if count < FEWEST_POINTS else "thin them out",
        )
    least = int(np.argmin(curve.radii))
    if curve.radii[least] <= 0:
        raise InputError(
            _where(curve, least),
            f"has a radius of {1e3 * curve.radii[least]:.4g} mm, at or beyond the shaft",
            "give radii, or lifts with motor.cam.base_radius; points have the shaft at 0, 0",
        )


def _forwards(curve: GivenCurve) -> GivenCurve:
    """In order of rising angle: points of the plane say where they lie, rows of a table may not."""
    if curve.sorted_by_us:
        order = np.argsort(curve.angles % (2 * pi), kind="stable")
        angles = curve.angles[order] % (2 * pi)
        first = (int(np.argmax(np.diff(angles, append=angles[0] + 2 * pi))) + 1) % len(angles)
        order = np.roll(order, -first)
        angles = np.unwrap(np.roll(angles, -first))
        kept = np.append(True, np.diff(angles) > _SAME_ANGLE)
        return replace(
            curve, angles=angles[kept], radii=curve.radii[order][kept], places=("",) * sum(kept)
        )
    return curve


def _require_order(curve: GivenCurve) -> None:
    steps = np.diff(curve.angles)
    if np.mean(steps < 0) > 0.5:
        raise InputError(
            curve.shown,
            "runs the wrong way: its angles fall from row to row",
            "write the rows in order of rising angle, which grows from +x towards +y as seen where "
            "the shaft turns anticlockwise",
        )
    for place in np.flatnonzero(steps <= _SAME_ANGLE)[:1].tolist():
        angle = degrees(curve.angles[place + 1])
        here, before = curve.places[place + 1], curve.places[place]
        if steps[place] > -_SAME_ANGLE:
            raise InputError(
                _where(curve, place + 1),
                f"has the angle {angle:.6g} deg a second time, after {before}",
                "leave one of the two out, or write their mean",
            )
        raise InputError(
            _where(curve, place + 1),
            f"goes back to {angle:.6g} deg from {degrees(curve.angles[place]):.6g} deg at {before}",
            f"put the rows in order of rising angle{'' if here else ', or thin the points out'}",
        )


def _without_last(curve: GivenCurve, tolerance: float) -> GivenCurve:
    """A closed curve's last point is its first again."""
    apart = abs(float(curve.radii[-1] - curve.radii[0]))
    if apart > tolerance:
        raise InputError(
            _where(curve, len(curve.radii) - 1),
            f"does not close: its radius is {1e3 * curve.radii[-1]:.6g} mm where "
            f"{curve.places[0] or 'the first point'} has {1e3 * curve.radii[0]:.6g} mm, "
            f"{1e6 * apart:.3g} um apart",
            f"leave it out, or set motor.cam.tolerance above {1e6 * apart:.3g} um",
        )
    return replace(
        curve, angles=curve.angles[:-1], radii=curve.radii[:-1], places=curve.places[:-1]
    )


def _require_no_gap(curve: GivenCurve, usual: float) -> None:
    """No step much longer than the others; a drawing's are as long as its pieces."""
    steps = np.diff(curve.angles)
    place = int(np.argmax(steps))
    widest = max(_GAP * usual, np.radians(12.0) if curve.sorted_by_us else 0.0)
    if steps[place] > widest:
        low, high = np.degrees(curve.angles[place : place + 2])
        raise InputError(
            _where(curve, place + 1),
            f"leaves a gap from {low:.5g} to {high:.5g} deg, where points are usually "
            f"{degrees(usual):.3g} deg apart",
            "give the points between, or all points as far apart",
        )


def _where(curve: GivenCurve, place: int) -> str:
    return f"{curve.shown} {curve.places[place]}".strip()
