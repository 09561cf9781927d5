"""Many motors over one period of their cams, side by side (`numerics/lanes.py`).

Every number of motor, oil and duty has a lane for each motor along its last axis;
the laws are the same objects as for one motor, for they are plain arithmetic. What
needs a search of its own in every lane is left to `cycle.py`: planar cams, tabulated
windows and the manifold. `fits` says which motors can go this way.
"""

from dataclasses import dataclass
from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.cam import RadialCam
from camring.geometry.lane_cam import RoundTheCam, radius_at, round_the_cam
from camring.geometry.window import TabulatedWindow
from camring.numerics.equation import Equation
from camring.numerics.lane_periodic import LaneResolution, settle_lanes, solve_lanes
from camring.numerics.lanes import ascending_rows
from camring.numerics.mesh import LAYER_ELEMENTS
from camring.numerics.once import computed_once
from camring.numerics.quantity import Q
from camring.numerics.spline import Jet
from camring.numerics.spline import knots as spline_knots
from camring.numerics.verdict import Verdict, verdict
from camring.physics.chamber import Chamber, chamber_at
from camring.physics.cycle import Cycle, quasi_steady, rate_in_state
from camring.physics.fluid import AbstractFluid
from camring.physics.motor import Motor
from camring.physics.operating_point import OperatingPoint
from camring.physics.rotation import turned


@dataclass(frozen=True)
class LanesLook:
    """How finely a batch is looked at, for each lobe pitch; all static."""

    elements: int = 240
    """Beside those that the window edges take for themselves."""
    oversampling: int = 16
    """Places at which spectra are sampled, for each order that counts."""
    tolerance: float = 1e-4
    """Of Newton's last step but one, over the range of the pressure."""
    knots: bool = True
    """Whether knots of the cam are nodes, so that no element holds a jump of jerk."""
    per_segment: int = 3
    """Elements between two breakpoints on the first mesh."""

    @classmethod
    def search(cls) -> "LanesLook":
        """For searching: objective terms to about 1e-4."""
        return cls(80, oversampling=8, knots=False, per_segment=6)


UNIQUE_DECAY = 1e-8  # what rounding leaves of a period in which nothing is renewed


class Operating(NamedTuple):
    """Cam and chamber at some places: what the pressure equation is told."""

    radius: Jet
    chamber: Chamber


class LaneCycle(NamedTuple):
    """Periodic solutions with what is known at their collocation points."""

    cycle: Cycle
    """Its arrays have lanes along their last axis."""
    cam: RoundTheCam
    at_stages: Operating
    """Shape (3, element, lane)."""


def fits(motor: Motor) -> bool:
    """Whether motors of this structure can be simulated in lanes."""
    tabulated = isinstance(motor.valve_plate.window, TabulatedWindow)
    return isinstance(motor.cam, RadialCam) and not tabulated and motor.manifold is None


def radial(motor: Motor) -> RadialCam:
    """The cam of a motor that `fits`."""
    assert isinstance(motor.cam, RadialCam)
    return motor.cam


def simulate_lanes(
    motor: Motor, fluid: AbstractFluid, point: OperatingPoint, look: LanesLook
) -> LaneCycle:
    """The periodic cycles of many motors at once; faults are in `cycle.verdict`.

    Parameters
    ----------
    motor, fluid, point
        Leaves (lane,), control radii (control, lane).
    """
    # What later steps share is computed once: without the barriers the compiler would
    # write it into every loop that reads it.
    motor, fluid, point = computed_once((turned(motor, point), fluid, point))
    cam = computed_once(round_the_cam(radial(motor)))
    reference = computed_once(reference_radii(motor, cam))
    breakpoints, sharp, own = _breakpoints(motor, look.knots)
    elements = look.elements * (motor.lobes // motor.cam.repeats) + own
    resolution = LaneResolution(elements, look.per_segment, look.tolerance)
    solved = solve_lanes(
        _equation(motor, fluid, point, reference), breakpoints, sharp, motor.cam.period, resolution
    )
    cycle = Cycle(motor, fluid, point, reference, solved.orbit, None, verdict())
    cycle = eqx.tree_at(lambda each: each.verdict, cycle, _verdict(cycle, cam, solved.decay, look))
    return LaneCycle(cycle, cam, solved.at_stages)


def neighbour_lanes(
    known: Cycle, motor: Motor, fluid: AbstractFluid, point: OperatingPoint, look: LanesLook
) -> LaneCycle:
    """Cycles of motors very near to those of cycles at hand; see `cycle.neighbour`."""
    motor = turned(motor, point)
    cam = round_the_cam(radial(motor))
    reference = reference_radii(motor, cam)
    breakpoints, _, _ = _breakpoints(motor, look.knots)
    equation = _equation(motor, fluid, point, reference)
    settled = settle_lanes(equation, breakpoints, motor.cam.period, known.orbit)
    cycle = Cycle(motor, fluid, point, reference, settled.orbit, None, known.verdict)
    return LaneCycle(cycle, cam, settled.at_stages)


def reference_radii(motor: Motor, cam: RoundTheCam) -> Q[Float[Array, " lane"], "m"]:
    """The radius that each motor's lift is counted from. model.md section 2."""
    if motor.reference == "given":
        return motor.given_reference_radius
    if motor.reference == "mean":
        return jnp.mean(radial(motor).control_radii, axis=0)
    return cam.extremes()[0]


def operating_at(
    motor: Motor,
    reference: Q[Float[Array, " lane"], "m"],
    angle: Q[Float[Array, "*grid lane"], "rad"],
) -> Operating:
    """Cam and chamber where each lane's piston stands."""
    radius = radius_at(radial(motor), angle)
    return Operating(radius, chamber_at(motor, reference, angle, radius))


def _equation(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    reference: Q[Float[Array, " lane"], "m"],
) -> Equation:
    return Equation((motor, fluid, point, reference), _rate, _forcing, _guess)


def _forcing(
    parameters: tuple,
    start: Float[Array, "element lane"],
    width: Float[Array, "element lane"],
    fraction: Float[Array, " point"],
) -> Operating:
    motor, _, _, reference = parameters
    return operating_at(motor, reference, start + fraction[:, None, None] * width)


def _rate(parameters: tuple, here: Operating, state: Array) -> Array:
    return rate_in_state(parameters, here.chamber, state)


def _guess(parameters: tuple, here: Operating) -> Array:
    return quasi_steady(parameters, here.chamber)


def _breakpoints(motor: Motor, knots: bool) -> tuple[Array, Array, int]:
    """Places of one cam period that shall be nodes, which of them are sharp, and the
    number of elements that they take for themselves."""
    edges = motor.valve_plate.breakpoints()
    turns = range(motor.lobes // motor.cam.repeats)
    places = jnp.concatenate([edges + turn * motor.valve_plate.pitch for turn in turns])
    sharp = jnp.ones_like(places)
    own = (1 + LAYER_ELEMENTS) * places.shape[0]
    if knots:
        cam = radial(motor)
        fixed = spline_knots(cam.control_radii.shape[0], cam.period, cam.degree)
        at = jnp.broadcast_to(jnp.asarray(fixed)[:, None], (len(fixed), places.shape[-1]))
        # A knot on an edge goes first, so that the element behind both knows it is sharp.
        places = jnp.concatenate([at, places])
        sharp = jnp.concatenate([jnp.zeros_like(at), sharp])
        own += len(fixed)
    ordered, which = ascending_rows(places % motor.cam.period, sharp)
    return ordered, which, own


def _verdict(
    cycle: Cycle, cam: RoundTheCam, decay: Float[Array, " lane"], look: LanesLook
) -> Verdict:
    motor, orbit = cycle.motor, cycle.orbit
    lowest, _ = cam.extremes()
    least_volume = motor.dead_volume + motor.piston.area * (lowest - cycle.reference_radius)
    unique = decay > UNIQUE_DECAY
    return verdict(
        chamber_volume_not_positive=~(least_volume > 0),
        orbit_not_unique=~unique,
        not_converged=unique & ~(orbit.residual < look.tolerance / 10),
    )
