"""What `import camring` offers to simulate: a motor of classes, or a motor file as it stands."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, overload

import numpy as np
from jaxtyping import Float

from camring.evaluation.outcome import Outcome
from camring.files.errors import InputError
from camring.metrics.summary import Metrics
from camring.physics.cycle import Cycle
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint
from camring.physics.resolution import Resolution
from camring.physics.system import System
from camring.programs.compiled import (
    assess_solved,
    simulate_compiled,
    slopes_with_results,
    solve,
    summarise_compiled,
)

if TYPE_CHECKING:
    from camring.files.motor import MotorFile

__all__ = ["Gradients", "gradients", "motor_file_of", "simulate", "summarise"]


@overload
def simulate(
    given: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    resolution: Resolution | None = None,
) -> Cycle: ...


@overload
def simulate(
    given: "MotorFile | System | str | Path", *, resolution: Resolution | None = None
) -> tuple[Cycle, ...]: ...


def simulate(
    given: "Motor | MotorFile | System | str | Path",
    fluid: AbstractFluid | None = None,
    point: OperatingPoint | None = None,
    resolution: Resolution | None = None,
) -> Cycle | tuple[Cycle, ...]:
    """The periodic cycle of a motor with its oil at an operating point, or those of a motor file.

    Parameters
    ----------
    given
        A `Motor`, which needs `fluid` and `point`; or a motor file by its name or as
        `read_motor_file` gives it, or its `System`, which have their own.

    Returns
    -------
    For a `Motor` one `Cycle`. For everything else a tuple of them, one for each operating
    point in the file's order, also where there is only one. `summarise` takes both.

    Raises
    ------
    InputError
        For a motor file that cannot be read, or when oil and operating point are missing or
        given twice. Of a motor that cannot be simulated `cycle.verdict` says why.

    Examples
    --------
    >>> cycles = camring.simulate("motor.toml")
    >>> cycles
    (Cycle: 8 pistons, 6 lobes; 100 rpm, supply 250 bar, return 10 bar; sound,)
    >>> print(f"{camring.summarise(cycles)[0].mean_torque:.1f} N m")
    2614.6 N m

    Notes
    -----
    Compiled, one program for all motors of the same counts and laws; traceable and
    differentiable.
    """
    if isinstance(given, Motor):
        if fluid is None or point is None:
            raise InputError(
                "camring.simulate",
                "was given a motor without its oil or operating point",
                "call camring.simulate(motor, fluid, point), or give it the motor file",
            )
        return simulate_compiled(given, fluid, point, resolution)
    if fluid is not None or point is not None:
        raise InputError(
            "camring.simulate",
            "was given oil or operating point beside something that has its own",
            "call camring.simulate(motor_file), or camring.simulate(motor, fluid, point) with "
            "motor = motor_file.system.motor",
        )
    system = given if isinstance(given, System) else motor_file_of(given).system
    return tuple(
        simulate_compiled(system.motor, system.fluid, each, resolution)
        for each in system.operating_points
    )


@overload
def summarise(cycle: Cycle, highest_order: int = 600) -> Metrics: ...


@overload
def summarise(cycle: Sequence[Cycle], highest_order: int = 600) -> tuple[Metrics, ...]: ...


def summarise(
    cycle: Cycle | Sequence[Cycle], highest_order: int = 600
) -> Metrics | tuple[Metrics, ...]:
    """Every result of a cycle, or of each of several.

    Parameters
    ----------
    highest_order
        Of the sums in ripples, counted per revolution.

    Examples
    --------
    >>> found = camring.summarise(camring.simulate("motor.toml"))
    >>> len(found), found[0].operating_mode
    (1, 'motor')
    >>> results = found[0].to_dict()
    >>> round(results["efficiency"], 4), round(results["max_pressure"] / 1e5, 1)
    (0.9603, 249.1)
    """
    if isinstance(cycle, Cycle):
        return summarise_compiled(cycle, highest_order)
    return tuple(summarise_compiled(each, highest_order) for each in cycle)


@dataclass(frozen=True, eq=False)
class Gradients:
    """One design, and how objective, limits and results change with its variables.

    Attributes
    ----------
    names
        Of the design variables, as the motor file has them.
    point
        The design in the unit box: 0 and 1 are a variable's bounds.
    outcome
        Objective, constraints and results of the design.
    objective
        Derivatives of the objective without penalty by the unit coordinates.
    constraints
        The same of each limit's `g`.
    results
        The same of results, for each operating point: those that objective and limits are
        made of, and those asked for.
    """

    names: tuple[str, ...]
    point: Float[np.ndarray, " coordinate"]
    outcome: Outcome
    objective: Float[np.ndarray, " coordinate"]
    constraints: dict[str, Float[np.ndarray, " coordinate"]]
    results: tuple[dict[str, Float[np.ndarray, " coordinate"]], ...]


def gradients(
    given: "MotorFile | str | Path",
    point: Sequence[float] | None = None,
    results: Sequence[str] = (),
) -> Gradients:
    """Exact derivatives by every design variable, for a fraction of a simulation each.

    Parameters
    ----------
    point
        A design in the unit box; the motor as the file gives it unless given.
    results
        Names of results whose derivatives are wanted, too.

    Raises
    ------
    InputError
        For a file without a design space, a point of another length, or a name that is no
        result.

    Examples
    --------
    >>> found = camring.gradients("motor.toml", [0.6, 0.5], results=["mean_torque"])
    >>> found.names
    ('motor.valve_plate.shift', 'motor.dead_volume')
    >>> [round(float(each), 1) for each in found.results[0]["mean_torque"]]
    [-168.3, -0.9]

    Notes
    -----
    Where an edge of a window lies exactly on another or on a knot of the cam, derivatives by
    what parts them are wrong: a known failure (docs/notes/verification.md).
    """
    import jax

    from camring.evaluation.assessed import outcome_of
    from camring.files.motor.motor_file import missing_design_space

    file = motor_file_of(given)
    space, system = file.design_space, file.system
    if space is None:
        raise missing_design_space(file.path)
    _require_results(results)
    at = np.asarray(space.locate(system) if point is None else point, dtype=float)
    if at.shape != (space.dimension,):
        raise InputError(
            "the point",
            f"has the shape {at.shape}",
            f"give {space.dimension} numbers from 0 to 1, for {', '.join(space.names)}",
        )
    design = solve(space.apply(system, at), file.goal)
    found, of_results = jax.device_get(
        slopes_with_results(space, system, at, design, file.goal, tuple(results))
    )
    return Gradients(
        names=tuple(space.names),
        point=at,
        outcome=outcome_of(assess_solved(design, file.goal)),
        objective=found.objective,
        constraints=found.constraints,
        results=tuple(of_results),
    )


def motor_file_of(given: "MotorFile | str | Path") -> "MotorFile":
    """A motor file itself, or read by its name.

    Raises
    ------
    InputError
        When it cannot be read, or is something else.
    """
    from camring.files.motor import MotorFile, read_motor_file

    if isinstance(given, MotorFile):
        return given
    if isinstance(given, str | Path):
        return read_motor_file(given)
    raise InputError(
        "the motor",
        f"is {type(given).__name__}, which is no motor",
        "give the name of a motor file, a MotorFile, a System, or a Motor with oil and "
        "operating point",
    )


def _require_results(names: Sequence[str]) -> None:
    from camring.files.motor.keys import nearest
    from camring.files.result_names import result_names

    known = result_names()
    for name in names:
        if name not in known:
            close = nearest(name, list(known))
            raise InputError(
                f"the result {name}",
                "is none",
                f"you probably meant {close}" if close else f"give some of {', '.join(known)}",
            )
