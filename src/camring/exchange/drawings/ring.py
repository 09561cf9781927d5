"""The ring as it is to be made: both curves, their splines, and what limits them."""

from dataclasses import dataclass
from math import degrees, pi

from camring.files.errors import InputError
from camring.files.motor import MotorFile
from camring.files.motor.document import printable
from camring.geometry.outline import Outline, Undercut, outline_of
from camring.numerics.closed_spline import ClosedSpline, FitError

__all__ = ["NORMAL_ERROR", "Ring", "ring_of"]

NORMAL_ERROR = 1e-7
"""How far the exported splines may stray from the exact curves, m."""

_LARGEST = 10.0  # m; a ring beyond it is a slip of the unit


@dataclass(frozen=True, eq=False)
class Ring:
    """A ring without undercut, ready to be drawn; lengths in m, angles in rad.

    Attributes
    ----------
    pitch, surface
        The path of the roller centre and the ring's inside as closed cubic splines.
    inner, outer
        Smallest and largest pitch radius, each with its angle.
    hollow, nose
        Smallest radius of curvature of the surface where it is hollow, which a grinding
        wheel must stay below, and where it bulges inwards (infinite where it never does).
    """

    outline: Outline
    roller_radius: float
    roller_length: float
    bore: float
    lobes: int
    pistons: int
    repeats: int
    pitch: ClosedSpline
    surface: ClosedSpline
    undercut: Undercut
    inner: tuple[float, float]
    outer: tuple[float, float]
    hollow: float
    nose: float

    @property
    def stroke(self) -> float:
        return self.outer[0] - self.inner[0]

    @property
    def surface_inner(self) -> float:
        """Smallest radius of the working surface; normals are radial there."""
        return self.inner[0] + self.roller_radius

    @property
    def surface_outer(self) -> float:
        """Largest radius of the working surface."""
        return self.outer[0] + self.roller_radius

    @property
    def period(self) -> float:
        """Angle after which the ring repeats."""
        return 2 * pi / self.repeats


def ring_of(file: MotorFile) -> Ring:
    """The ring of a motor file.

    Raises
    ------
    InputError
        When its working surface cannot exist: undercut, or cut by the roller elsewhere.
    """
    motor = file.system.motor
    outline, roller = outline_of(motor.cam), float(motor.roller.radius)
    undercut = outline.undercut(roller)
    _require_no_undercut(file, undercut, outline, roller)
    try:
        pitch, surface = outline.fit(0.0, NORMAL_ERROR), outline.fit(roller, NORMAL_ERROR)
    except FitError as error:
        raise InputError(
            printable(file.path),
            f"has a ring that no drawing can hold within {1e6 * NORMAL_ERROR:g} um: its undercut "
            f"factor falls to {undercut.factor:.3g} at {degrees(undercut.angle):.4g} deg, nearly a "
            f"cusp (a spline {error})",
            "make the cam rounder there, or set [constraints] min_undercut_factor = 0.1 and "
            "optimise",
        ) from error
    low, high = outline.sharpest(roller)
    return Ring(
        outline=outline,
        roller_radius=roller,
        roller_length=float(motor.roller.length),
        bore=float(motor.piston.bore),
        lobes=motor.lobes,
        pistons=motor.pistons,
        repeats=motor.cam.repeats,
        pitch=pitch,
        surface=surface,
        undercut=undercut,
        inner=outline.extreme_radius(-1),
        outer=outline.extreme_radius(1),
        hollow=1 / high,
        nose=-1 / low if low < 0 else float("inf"),
    )


def _require_no_undercut(
    file: MotorFile, undercut: Undercut, outline: Outline, roller: float
) -> None:
    shown = printable(file.path)
    if outline.extreme_radius(1)[0] > _LARGEST:
        raise InputError(
            shown,
            f"has a ring of {outline.extreme_radius(1)[0]:.4g} m, more than {_LARGEST:g} m",
            'check the unit of the cam\'s radii, such as "90 mm"',
        )
    if undercut.factor <= 0:
        # factor = 1 - roller / (radius of curvature), so this roller would just do.
        least = roller / (1 - undercut.factor)
        raise InputError(
            shown,
            f"has an undercut ring: its undercut factor is {undercut.factor:.3g} at "
            f"{degrees(undercut.angle):.4g} deg and must be above 0, or no working surface "
            "exists there",
            f"take a roller of less than {1e3 * least:.4g} mm radius (it has "
            f"{1e3 * roller:.4g} mm), make the cam rounder there, or set "
            "[constraints] min_undercut_factor = 0.1 and optimise; `--only plate` still works",
        )
    depth = outline.cuts_into_itself(roller)
    if depth > 0:
        raise InputError(
            shown,
            f"has a ring into which its own roller of {1e3 * roller:.4g} mm radius would cut "
            f"{1e6 * depth:.3g} um deep, from a place further along",
            "take a smaller roller or a cam of longer flanks; `--only plate` still works",
        )
