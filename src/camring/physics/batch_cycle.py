"""Many motors over one period of their cams, side by side (`numerics/batch.py`).

Every number of motor, oil and operating point has a place for each motor along its last axis;
the laws are the same objects as for one motor, for they are plain arithmetic. What
needs a search of its own for every motor is left to `cycle.py`: planar cams, tabulated
windows and the manifolds. `fits` says which motors can go this way.
"""

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.batch_cam import SAMPLES_PER_SPAN, RoundTheCam, radius_at, round_the_cam
from camring.geometry.cam import RadialCam
from camring.geometry.window import TabulatedWindow
from camring.numerics.batch import ascending_rows
from camring.numerics.batch_mesh import graded_batch
from camring.numerics.batch_periodic import (
    PeriodicResolution,
    carry_batch,
    settle_batch,
    solve_periodic_batch,
    step_batch,
)
from camring.numerics.compilation import computed_once
from camring.numerics.equation import Equation
from camring.numerics.mesh import LAYER_ELEMENTS
from camring.numerics.periodic import Orbit
from camring.numerics.quantity import Q
from camring.numerics.radau import STAGES
from camring.numerics.spline import Jet
from camring.numerics.spline import knots as spline_knots
from camring.numerics.verdict import Verdict, verdict
from camring.physics.chamber import Chamber, chamber_at
from camring.physics.cycle import Cycle, quasi_steady, rate_in_state
from camring.physics.manifold.sides import sides_of
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint
from camring.physics.pressure import kinks
from camring.physics.rotation import turned


@dataclass(frozen=True)
class BatchResolution:
    """How finely a batch is solved, for each lobe pitch; all static."""

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
    refinements: int = 1
    """Meshes laid from a solution on the one before; all but the first of these have nodes
    where the pressure meets a kink of oil or orifice."""
    parts: int = SAMPLES_PER_SPAN
    """Of a span between two knots of the cam, for extremes of its own."""
    integrated: bool = False
    """Whether spectra are those of waves integrated before they are sampled, whose error does
    not grow where windows open slowly and flows jump."""

    @classmethod
    def search(cls) -> "BatchResolution":
        """For searching: objective terms to about 1e-4."""
        return cls(80, oversampling=8, knots=False, per_segment=6)

    @classmethod
    def fine(cls) -> "BatchResolution":
        """For printed numbers: results to 1e-5, but for motors that `ladder` is there for."""
        return cls(
            320,
            oversampling=12,
            tolerance=1e-6,
            per_segment=8,
            refinements=3,
            parts=24,
            integrated=True,
        )

    @classmethod
    def ladder(cls) -> "tuple[BatchResolution, ...]":
        """What is tried in turn until an accuracy is reached, as `Resolution.ladder`."""
        fine = cls.fine()
        return tuple(replace(fine, elements=times * fine.elements) for times in (1, 2, 4))

    def second_solution(self, share: float) -> "BatchResolution":
        """A coarser one that an error estimate compares with."""
        return replace(self, elements=round(share * self.elements))


COARSER = 0.7
"""Share of the elements with which a batch is solved once more, for an error estimate."""

GUESSED_ELEMENTS = 4
"""Between two breakpoints, where pressure is guessed: enough for means over a period."""

UNIQUE_DECAY = 1e-8  # what rounding leaves of a period in which nothing is renewed


class Operating(NamedTuple):
    """Cam and chamber at some places: what the pressure equation is given."""

    radius: Jet
    chamber: Chamber


class BatchCycle(NamedTuple):
    """Periodic solutions with what is known at their collocation points."""

    cycle: Cycle
    """Its arrays have the batch along their last axis."""
    cam: RoundTheCam
    at_stages: Operating
    """Shape (3, element, batch)."""


def fits(motor: Motor) -> bool:
    """Whether motors of this structure can be simulated in batches."""
    tabulated = isinstance(motor.valve_plate.window, TabulatedWindow)
    return isinstance(motor.cam, RadialCam) and not tabulated and not sides_of(motor)


def radial(motor: Motor) -> RadialCam:
    """The cam of a motor that `fits`."""
    assert isinstance(motor.cam, RadialCam)
    return motor.cam


def periodic_cycles(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    resolution: BatchResolution,
    filled: Float[Array, " batch"] | None = None,
) -> BatchCycle:
    """The periodic cycles of many motors at once; faults are in `cycle.verdict`.

    Parameters
    ----------
    motor, fluid, point
        Leaves (member,), control radii (control, member).
    filled
        Share of its elements that each motor's lobe pitch is divided into, all unless given:
        one program for several resolutions.
    """
    # What later steps share is computed once: without the barriers the compiler would
    # write it into every loop that reads it.
    motor, fluid, point = computed_once((turned(motor, point), fluid, point))
    cam = computed_once(round_the_cam(radial(motor), resolution.parts))
    reference = computed_once(reference_radii(motor, cam))
    breakpoints, sharp, own = _breakpoints(motor, resolution.knots)
    pitches = motor.lobes // motor.cam.repeats
    elements = resolution.elements * pitches + own
    used = None
    if filled is not None:
        used = jnp.round(filled * resolution.elements) * pitches + own
    several = resolution.refinements > 1  # then each mesh begins near what it shall find
    periodic = PeriodicResolution(
        elements,
        resolution.per_segment,
        resolution.tolerance,
        rough_tolerance=1e-3 if several else 0.2,
        limit=40 if several else 20,
        refinements=resolution.refinements,
        compact=several,
    )
    solved = solve_periodic_batch(
        _equation(motor, fluid, point, reference),
        breakpoints,
        sharp,
        motor.cam.period,
        periodic,
        used,
    )
    cycle = Cycle(
        motor, fluid, point, reference, solved.orbit, None, verdict(), _sprung(motor, cam)
    )
    found = _verdict(cycle, cam, solved.decay, resolution)
    cycle = eqx.tree_at(lambda each: each.verdict, cycle, found)
    return BatchCycle(cycle, cam, solved.at_stages)


def guessed_cycles(
    motor: Motor, fluid: AbstractFluid, point: OperatingPoint, resolution: BatchResolution
) -> BatchCycle:
    """Cycles whose chambers have at once the pressure of the ports that they are open to.

    Quick, and no solution of anything: to begin with.
    """
    motor = turned(motor, point)
    cam = computed_once(round_the_cam(radial(motor), resolution.parts))
    reference = computed_once(reference_radii(motor, cam))
    breakpoints, _, _ = _breakpoints(motor, knots=False)
    mesh = graded_batch(breakpoints, motor.cam.period, GUESSED_ELEMENTS)
    equation = _equation(motor, fluid, point, reference)
    at_stages = equation.forcing(mesh, jnp.asarray(STAGES))
    state = equation.guess(at_stages)
    unsolved = jnp.full_like(state[0, 0], jnp.inf)
    node_state = jnp.roll(state[2], 1, axis=0)  # what an element ends with the next begins with
    orbit = Orbit(mesh, node_state, state, unsolved, jnp.zeros((), int))
    cycle = Cycle(motor, fluid, point, reference, orbit, None, verdict(), _sprung(motor, cam))
    return BatchCycle(cycle, cam, at_stages)


def nearby_cycles(
    known: Cycle,
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    resolution: BatchResolution,
) -> BatchCycle:
    """Cycles of motors very near to those of cycles at hand; see `cycle.nearby_cycle`."""
    return settled(carried_over(known, motor, fluid, point, resolution))


def carried_over(
    known: Cycle,
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    resolution: BatchResolution,
) -> BatchCycle:
    """Cycles at hand with the numbers of motors very near to theirs; `settled` goes on."""
    motor = turned(motor, point)
    cam = round_the_cam(radial(motor), resolution.parts)
    reference = reference_radii(motor, cam)
    breakpoints, _, _ = _breakpoints(motor, resolution.knots)
    equation = _equation(motor, fluid, point, reference)
    orbit, at_stages = carry_batch(equation, breakpoints, motor.cam.period, known.orbit)
    cycle = Cycle(motor, fluid, point, reference, orbit, None, known.verdict, _sprung(motor, cam))
    return BatchCycle(cycle, cam, at_stages)


def settled(found: BatchCycle) -> BatchCycle:
    """Cycles after a Newton step from what their orbits are, with all its derivatives.

    For motors that have changed in nothing that moves cam, windows or chambers.
    """
    cycle = found.cycle
    equation = _equation(cycle.motor, cycle.fluid, cycle.point, cycle.reference_radius)
    orbit = settle_batch(equation, found.at_stages, cycle.orbit).orbit
    return found._replace(cycle=replace(cycle, orbit=orbit))


def stepped(found: BatchCycle) -> BatchCycle:
    """The same step without what tells how good it is."""
    cycle = found.cycle
    equation = _equation(cycle.motor, cycle.fluid, cycle.point, cycle.reference_radius)
    orbit = step_batch(equation, found.at_stages, cycle.orbit)
    return found._replace(cycle=replace(cycle, orbit=orbit))


def reference_radii(motor: Motor, cam: RoundTheCam) -> Q[Float[Array, " batch"], "m"]:
    """The radius that each motor's lift is counted from. docs/theory.md section 2."""
    if motor.reference == "given":
        return motor.given_reference_radius
    if motor.reference == "mean":
        return jnp.mean(radial(motor).control_radii, axis=0)
    return cam.extremes()[0]


def _sprung(motor: Motor, cam: RoundTheCam) -> Q[Float[Array, " batch"], "m"] | None:
    """From where the return springs' travel counts."""
    return None if motor.piston.spring is None else cam.extremes()[0]


def operating_at(
    motor: Motor,
    reference: Q[Float[Array, " batch"], "m"],
    angle: Q[Float[Array, "*grid batch"], "rad"],
) -> Operating:
    """Cam and chamber where each member's piston stands."""
    radius = radius_at(radial(motor), angle)
    return Operating(radius, chamber_at(motor, reference, angle, radius))


def _equation(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    reference: Q[Float[Array, " batch"], "m"],
) -> Equation:
    bends = kinks(motor, fluid, point.supply_pressure, point.return_pressure)
    return Equation((motor, fluid, point, reference), _rate, _forcing, _guess, bends)


def _forcing(
    parameters: tuple[Any, ...],
    start: Float[Array, "element batch"],
    width: Float[Array, "element batch"],
    fraction: Float[Array, " point"],
) -> Operating:
    motor, _, _, reference = parameters
    return operating_at(motor, reference, start + fraction[:, None, None] * width)


def _rate(parameters: tuple[Any, ...], here: Operating, state: Array) -> Array:
    return rate_in_state(parameters, here.chamber, state)


def _guess(parameters: tuple[Any, ...], here: Operating) -> Array:
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
    cycle: Cycle, cam: RoundTheCam, decay: Float[Array, " batch"], resolution: BatchResolution
) -> Verdict:
    motor, orbit = cycle.motor, cycle.orbit
    lowest, _ = cam.extremes()
    least_volume = motor.dead_volume + motor.piston.area * (lowest - cycle.reference_radius)
    unique = decay > UNIQUE_DECAY
    return verdict(
        chamber_volume_not_positive=~(least_volume > 0),
        orbit_not_unique=~unique,
        not_converged=unique & ~(orbit.residual < resolution.tolerance / 10),
    )
