"""The ports that open as the model says: slots of the valve plate, holes of the block.

The model knows when a chamber is open and by how much, not the shape of any
port. On a port circle of a chosen radius, the shapes follow: a chamber's port
of angular width `b` that slides over a slot of width `D - b` is open over `D`,
and comes to its full area over `b`. For the linear window both are sectors
between the same two radii, for the round one a hole over a slot with round
ends; of a tabulated window, and of two kinds whose areas differ, nothing but the angles
can be drawn. docs/theory.md sections 3, 13 and 14.
"""

from dataclasses import dataclass
from math import degrees, pi, sqrt
from typing import Literal

from camring.geometry.valve_plate import Port, ValvePlate
from camring.geometry.window import LinearWindow, RoundWindow

__all__ = ["PlatePorts", "PortError", "Slot", "ports_of"]

Kind = Literal["supply", "return"]
Shape = Literal["sector", "round", "timing"]


class PortError(ValueError):
    """Ports that cannot be cut on this port circle: the number, the limit and the way out."""

    def __init__(self, problem: str, least_radius: float | None) -> None:
        self.problem = problem
        self.least_radius = least_radius  # m; None where no radius helps
        super().__init__(problem)


@dataclass(frozen=True)
class Slot:
    """One slot of the valve plate; angles of the shaft, rad, ascending from start to end.

    Attributes
    ----------
    opens, closes
        Where the middle of a chamber's port stands when the window opens and closes.
    full_from, full_until
        Between them the chamber sees the whole port area.
    start, end
        Edges of the slot itself.
    notch_tip
        Where the relief notch begins in the plate; None without one.
    """

    kind: Kind
    number: int
    centre: float
    opens: float
    full_from: float
    full_until: float
    closes: float
    start: float
    end: float
    notch_tip: float | None


@dataclass(frozen=True)
class PlatePorts:
    """All slots of a plate and the port of a chamber that passes over them.

    Attributes
    ----------
    circle
        Radius of the circle on which the ports lie, m.
    height
        Radial height of slots and chamber ports, or the diameter of round ones, m.
    chamber_width
        Angle that a chamber's port takes up; 0 where the window gives none.
    ramp_error
        How much longer a window takes to open fully than the model says, as a share,
        the worst of both kinds; 0 where the ports are what the model computes with.
    """

    shape: Shape
    circle: float
    height: float
    chamber_width: float
    ramp_error: float
    slots: tuple[Slot, ...]

    @property
    def inner(self) -> float:
        return self.circle - self.height / 2

    @property
    def outer(self) -> float:
        return self.circle + self.height / 2


def ports_of(plate: ValvePlate, usual_circle: float, circle: float | None = None) -> PlatePorts:
    """The ports of a valve plate on a port circle.

    Parameters
    ----------
    usual_circle
        Radius of the port circle when none is asked for, m. Round ports then take
        the radius at which their diameter fits area and ramp, whatever this says.
    circle
        Radius of the port circle asked for, m.

    Raises
    ------
    PortError
        When ports of this area cannot lie on the circle, or slots run into each other.
    """
    kinds = (plate.supply, plate.return_)
    area, other = (float(plate.area_of(port)) for port in kinds)
    narrow = min(float(port.width) for port in kinds)
    window = plate.window
    if area != other:  # one port of a chamber opens to both kinds: no shape shows both areas
        shape: Shape = "timing"
        radius, width, height = circle or usual_circle, 0.0, sqrt(max(area, other))
    elif isinstance(window, RoundWindow):
        shape = "round"
        height = sqrt(4 * area / pi)
        modelled = _quickest(plate)
        radius = circle or height / modelled
        width = height / radius
        if width > narrow / 2 * (1 + 1e-9):
            raise PortError(
                f"puts round ports of {1e3 * height:.4g} mm on a port circle of "
                f"{1e3 * radius:.4g} mm, where they take {degrees(width):.4g} deg, more than half "
                f"the window of {degrees(narrow):.4g} deg",
                2 * height / narrow,
            )
    elif isinstance(window, LinearWindow):
        shape, radius = "sector", circle or usual_circle
        width = _quickest(plate)
        height = area / (radius * width)
        if height >= radius:
            raise PortError(
                f"puts ports of {1e6 * area:.4g} mm2 and {degrees(width):.3g} deg on a port circle "
                f"of {1e3 * radius:.4g} mm, where they would be {1e3 * height:.4g} mm high, more "
                "than the circle's own radius",
                sqrt(area / width),
            )
    else:
        shape, radius, width, height = "timing", circle or usual_circle, 0.0, sqrt(area)
    slots = _slots(plate, width)
    _require_land_between(slots)
    return PlatePorts(shape, radius, height, width, _ramp_error(plate, width), slots)


def _slots(plate: ValvePlate, chamber: float) -> tuple[Slot, ...]:
    found = []
    kinds: tuple[Kind, ...] = ("supply", "return")
    for kind, port in zip(kinds, (plate.supply, plate.return_), strict=True):
        half = float(port.width) / 2
        # A chamber port of no width is a window of which only the angles are known.
        reach = half - chamber / 2
        flat = half - chamber if chamber else half
        notch = plate.notch_of(port)
        tip = None if notch is None else float(notch.angle)
        for number in range(plate.lobes):
            centre = float(port.centre + plate.shift) + plate.pitch * number
            centre %= 2 * pi
            found.append(
                Slot(
                    kind,
                    number + 1,
                    centre,
                    centre - half,
                    centre - flat,
                    centre + flat,
                    centre + half,
                    centre - reach,
                    centre + reach,
                    None if tip is None else centre - reach - tip,
                )
            )
    return tuple(sorted(found, key=lambda slot: slot.centre))


def _require_land_between(slots: tuple[Slot, ...]) -> None:
    for slot, following in zip(slots, slots[1:] + slots[:1], strict=True):
        land = (following.start - slot.end + pi) % (2 * pi) - pi
        if len(slots) > 1 and land <= 0:
            raise PortError(
                f"has slots that run into each other by {degrees(-land):.3g} deg between the "
                f"{slot.kind} port at {degrees(slot.centre):.4g} deg and the {following.kind} port "
                "that follows",
                None,
            )


def _ramp(plate: ValvePlate, port: Port) -> float:
    """Angle over which a window of a kind comes to its full area."""
    window = plate.window_of(port)
    assert isinstance(window, (LinearWindow, RoundWindow))
    return float(window.ramp) * float(port.width) / 2


def _quickest(plate: ValvePlate) -> float:
    """That of the kind that opens over the smaller angle."""
    return min(_ramp(plate, port) for port in (plate.supply, plate.return_))


def _ramp_error(plate: ValvePlate, width: float) -> float:
    if not width:
        return 0.0
    errors = [width / _ramp(plate, port) - 1 for port in (plate.supply, plate.return_)]
    worst = max(errors, key=abs)
    return worst if abs(worst) > 1e-9 else 0.0
