"""Other people's solvers on the periodic pressure of one chamber (docs/theory.md section 3).

Each marches two periods from the supply pressure at the middle of a supply window and
gives the second. The state is the pressure above return over the supply-return
difference, so that one tolerance serves as relative and as absolute one. "Between kinks"
restarts the solver at each window edge and each knot of the cam; "straight through"
leaves them to its step control.
"""

from bisect import bisect_right
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from scipy.integrate import solve_ivp

from camring.physics.chamber import chamber_at
from camring.physics.cycle import reference_radius
from camring.physics.pressure import pressure_slope
from camring.physics.system import System
from camring.reference.chamber import Chamber

SCIPY_TOLERANCES = {
    "Radau": (1e-3, 1e-5, 1e-7),
    "BDF": (1e-3, 1e-5, 1e-7),
    "LSODA": (1e-3, 1e-5, 1e-7, 1e-9, 1e-11),
}
SUNDIALS_TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11)
DIFFRAX_TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
DIFFRAX_BATCH_TOLERANCES = (1e-3, 1e-5, 1e-7)


@dataclass
class Run:
    """One solver at one setting, ready to be timed."""

    solver: str
    setting: str
    solve: Callable[[], object]
    """Solves once more; nothing is sampled."""
    pressure: Callable[[], np.ndarray]
    """Pressure at the angles asked for, Pa."""
    designs: int = 1
    """Solved in one call."""


def scipy_runs(chamber: Chamber, angles: np.ndarray) -> Iterator[Run]:
    back = chamber.machine.return_pressure
    edges = chamber.edges.tolist()
    period = chamber.machine.period
    laws = [chamber.slopes(a, b, back) for a, b in pairwise(edges)]
    first = (chamber.machine.supply_pressure - back) / chamber.scale

    def anywhere(angle: float, state: np.ndarray) -> list[float]:
        if angle >= edges[-1]:
            angle -= period
        piece = min(bisect_right(edges, angle), len(laws)) - 1
        return [laws[piece](float(state[0]), angle)[0]]

    def in_piece(law: Callable) -> Callable:
        return lambda angle, state: [law(float(state[0]), angle)[0]]

    def straight(method: str, tolerance: float, at: np.ndarray | None) -> np.ndarray:
        spans = [(edges[0], edges[0] + 2 * period)]
        return _marched(method, tolerance, spans, [anywhere], None if at is None else at + period)

    def between(method: str, tolerance: float, at: np.ndarray | None) -> np.ndarray:
        fields = [in_piece(law) for law in laws]
        spans = list(pairwise(edges))
        later = [(a + period, b + period) for a, b in spans]
        moved = [lambda t, y, f=f: f(t - period, y) for f in fields]
        wanted = None if at is None else at + period
        return _marched(method, tolerance, spans + later, fields + moved, wanted)

    def _marched(
        method: str, tolerance: float, spans: list, fields: list, wanted: np.ndarray | None
    ) -> np.ndarray:
        state, found = [first], []
        for (begin, end), field in zip(spans, fields, strict=True):
            options = {"method": method, "rtol": max(tolerance, 3e-14), "atol": tolerance}
            if wanted is not None:
                options["dense_output"] = True
            done = solve_ivp(field, (begin, end), state, **options)
            state = done.y[:, -1]
            if wanted is not None:
                inside = wanted[(wanted >= begin) & (wanted < end)]
                found += done.sol(inside)[0].tolist() if inside.size else []
        return back + chamber.scale * np.asarray(found)

    for way, march in (("straight through", straight), ("between kinks", between)):
        for method, tolerances in SCIPY_TOLERANCES.items():
            for tolerance in tolerances:
                yield Run(
                    f"SciPy {method}, {way}",
                    f"{tolerance:.0e}",
                    lambda m=method, t=tolerance, march=march: march(m, t, None),
                    lambda m=method, t=tolerance, march=march: march(m, t, angles),
                )


def casadi_runs(chamber: Chamber, angles: np.ndarray) -> Iterator[Run]:
    """SUNDIALS' CVODES and IDAS; raises ImportError where CasADi is missing."""
    import casadi

    m, back, unit = chamber.machine, chamber.machine.return_pressure, chamber.scale
    edges = chamber.edges
    fixed = m.dead_volume - m.piston_area * chamber.reference

    def rate(angle: object, y: object, numbers: list) -> object:
        """dy/dtheta with the numbers of the piece that the angle lies in."""
        origin, scale, supply_at, return_at, *powers = numbers
        x = (angle - origin) * scale
        value = slope = 0
        for power in reversed(powers):
            slope = slope * x + value
            value = value * x + power
        pressure = back + unit * y
        net = -m.leakage_coefficient * (pressure - m.case_pressure)
        net -= m.piston_area * slope * scale * m.shaft_speed
        sides = ((m.supply, supply_at, m.supply_pressure), (m.return_, return_at, back))
        for window, at, port in sides:
            half = window.width / 2
            share = (half - casadi.fabs(angle - at)) / (window.ramp * half)
            drop = port - pressure
            flow = m.discharge_coefficient * m.port_area * (2 / m.oil.density) ** 0.5 * drop
            root = (drop**2 + m.oil.transition_pressure**2) ** 0.25
            net += casadi.fmin(casadi.fmax(share, 0), 1) * flow / root
        volume = fixed + m.piston_area * value
        return m.oil.bulk_modulus * net / (m.shaft_speed * volume * unit)

    pieces = []
    for begin, end in pairwise(edges):
        piece, turns = chamber.piece_at((begin + end) / 2)
        centres = [chamber.nearest_centre(w, (begin + end) / 2) for w in (m.supply, m.return_)]
        pieces.append([piece.origin + turns, piece.scale, *centres, *piece.coefficients])
    table = np.array(pieces)
    first = (m.supply_pressure - back) / unit
    y, t, p = casadi.SX.sym("y"), casadi.SX.sym("t"), casadi.SX.sym("p", 2 + table.shape[1])
    numbers = [casadi.pw_const(t, edges[1:-1], column) for column in table.T]
    whole = {"x": y, "t": t, "ode": rate(t, y, numbers)}
    own = [p[k + 2] for k in range(table.shape[1])]
    part = {"x": y, "t": t, "p": p, "ode": p[1] * rate(p[0] + t * p[1], y, own)}
    spans = np.column_stack([edges[:-1], np.diff(edges), table])

    def straight(plugin: str, options: dict) -> tuple[Callable, Callable]:
        end = casadi.integrator("end", plugin, whole, edges[0], edges[-1], options)
        grid = casadi.integrator("grid", plugin, whole, edges[0], angles, options)
        return (
            lambda: end(x0=end(x0=first)["xf"])["xf"],
            lambda: back + unit * np.asarray(grid(x0=end(x0=first)["xf"])["xf"]).ravel(),
        )

    def between(plugin: str, options: dict) -> tuple[Callable, Callable]:
        end = casadi.integrator("end", plugin, part, 0.0, 1.0, options)

        def once(state: object) -> object:
            for span in spans:
                state = end(x0=state, p=span)["xf"]
            return state

        def sampled() -> np.ndarray:
            state, found = once(first), []
            for span in spans:
                places = (angles - span[0]) / span[1]
                inside = places[(places > 0) & (places < 1)]
                nodes = np.append(inside, 1.0)
                grid = casadi.integrator("grid", plugin, part, 0.0, nodes, options)
                values = np.asarray(grid(x0=state, p=span)["xf"]).ravel()
                state = values[-1]
                found.append(values[:-1])
            return back + unit * np.concatenate(found)

        return lambda: once(once(first)), sampled

    for way, make in (("straight through", straight), ("between kinks", between)):
        for plugin in ("cvodes", "idas"):
            for tolerance in SUNDIALS_TOLERANCES:
                options = {"reltol": tolerance, "abstol": tolerance, "max_num_steps": 1_000_000}
                solve, pressure = make(plugin, options)
                name = f"CasADi {plugin.upper()}, {way}"
                yield Run(name, f"{tolerance:.0e}", solve, pressure)


def diffrax_runs(
    system: System, chamber: Chamber, angles: np.ndarray, many: np.ndarray
) -> Iterator[Run]:
    """Kvaerno's ESDIRK pairs, compiled; raises ImportError where diffrax is missing.

    `many` holds control radii of other designs, one a row, for a batch under `vmap`; their
    first is the system's own cam.
    """
    import diffrax

    back, unit, period = chamber.machine.return_pressure, chamber.scale, chamber.machine.period
    fluid, point = system.fluid, system.operating_points[0]
    begin = float(chamber.edges[0])
    kinks = jnp.asarray(np.concatenate([chamber.edges[1:], chamber.edges[1:-1] + period]))
    first = jnp.asarray((chamber.machine.supply_pressure - back) / unit)
    last, places = diffrax.SaveAt(t1=True), diffrax.SaveAt(ts=jnp.asarray(angles + period))

    def field(angle: jax.Array, y: jax.Array, known: tuple) -> jax.Array:
        motor, reference = known
        here = chamber_at(motor, reference, angle, motor.cam.pitch_radius(angle))
        return pressure_slope(motor, fluid, point, here, back + unit * y) / unit

    def march(
        radii: jax.Array, tolerance: jax.Array, saved: object, solver: diffrax.AbstractSolver
    ) -> jax.Array:
        motor = eqx.tree_at(lambda each: each.cam.control_radii, system.motor, radii)
        return diffrax.diffeqsolve(
            diffrax.ODETerm(field),
            solver,
            begin,
            begin + 2 * period,
            None,
            first,
            args=(motor, reference_radius(motor)),
            saveat=saved,
            stepsize_controller=diffrax.ClipStepSizeController(
                diffrax.PIDController(rtol=tolerance, atol=tolerance), jump_ts=kinks
            ),
            max_steps=1_000_000,
        ).ys

    for solver in (diffrax.Kvaerno3(), diffrax.Kvaerno5()):
        name = f"diffrax {type(solver).__name__}"
        end = jax.jit(partial(march, saved=last, solver=solver))
        sampled = jax.jit(partial(march, saved=places, solver=solver))
        for tolerance in DIFFRAX_TOLERANCES:
            yield Run(
                f"{name}, between kinks",
                f"{tolerance:.0e}",
                partial(_ready, end, many[0], tolerance),
                lambda sampled=sampled, t=tolerance: back + unit * np.asarray(sampled(many[0], t)),
            )
        batch = jax.jit(jax.vmap(partial(march, saved=last, solver=solver), (0, None)))
        for tolerance in DIFFRAX_BATCH_TOLERANCES:
            yield Run(
                f"{name}, {len(many)} under vmap",
                f"{tolerance:.0e}",
                partial(_ready, batch, many, tolerance),
                lambda sampled=sampled, t=tolerance: back + unit * np.asarray(sampled(many[0], t)),
                designs=len(many),
            )


def _ready(program: Callable, *given: object) -> object:
    return jax.block_until_ready(program(*given))
