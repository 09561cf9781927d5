"""Better cam rings and valve timing for radial-piston hydraulic motors.

Everything here is loaded when it is first asked for, so that `import camring`
and `camring --help` cost nothing.

>>> import camring
>>> motor_file = camring.read_motor_file("examples/wheel_motor.toml")  # doctest: +SKIP
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from camring.interfaces import optuna, plots
    from camring.interfaces.compiled import (
        evaluate,
        simulate,
        simulate_to,
        summarise,
        waveforms,
    )
    from camring.interfaces.config import MotorFile, read_motor_file
    from camring.interfaces.errors import InputError
    from camring.interfaces.executors import Workers
    from camring.interfaces.fitting import Fit, fit
    from camring.interfaces.operating_map import operating_map
    from camring.interfaces.optimisation import optimise, resume
    from camring.interfaces.optuna import export_to_optuna
    from camring.interfaces.own_function import FunctionMinimum, minimise_function
    from camring.interfaces.study import Study, open_study
    from camring.interfaces.sweep import sweep
    from camring.metrics.summary import Metrics
    from camring.objective.constraints import Constraints
    from camring.objective.design_space import DesignSpace
    from camring.objective.objective import Goal
    from camring.objective.terms import Weights
    from camring.physics.cycle import Cycle
    from camring.physics.motor import Motor
    from camring.physics.operating_point import OperatingPoint
    from camring.physics.resolution import Resolution
    from camring.physics.system import System

__version__ = "0.1.0"

_HOMES = {
    "Constraints": "camring.objective.constraints",
    "Cycle": "camring.physics.cycle",
    "DesignSpace": "camring.objective.design_space",
    "Fit": "camring.interfaces.fitting",
    "FunctionMinimum": "camring.interfaces.own_function",
    "Goal": "camring.objective.objective",
    "InputError": "camring.interfaces.errors",
    "Metrics": "camring.metrics.summary",
    "Motor": "camring.physics.motor",
    "MotorFile": "camring.interfaces.config",
    "OperatingPoint": "camring.physics.operating_point",
    "Resolution": "camring.physics.resolution",
    "Study": "camring.interfaces.study",
    "System": "camring.physics.system",
    "Weights": "camring.objective.terms",
    "Workers": "camring.interfaces.executors",
    "evaluate": "camring.interfaces.compiled",
    "export_to_optuna": "camring.interfaces.optuna",
    "fit": "camring.interfaces.fitting",
    "minimise_function": "camring.interfaces.own_function",
    "open_study": "camring.interfaces.study",
    "operating_map": "camring.interfaces.operating_map",
    "optimise": "camring.interfaces.optimisation",
    "read_motor_file": "camring.interfaces.config",
    "resume": "camring.interfaces.optimisation",
    "simulate": "camring.interfaces.compiled",
    "simulate_to": "camring.interfaces.compiled",
    "summarise": "camring.interfaces.compiled",
    "sweep": "camring.interfaces.sweep",
    "waveforms": "camring.interfaces.compiled",
}

__all__ = [
    "Constraints",
    "Cycle",
    "DesignSpace",
    "Fit",
    "FunctionMinimum",
    "Goal",
    "InputError",
    "Metrics",
    "Motor",
    "MotorFile",
    "OperatingPoint",
    "Resolution",
    "Study",
    "System",
    "Weights",
    "Workers",
    "__version__",
    "evaluate",
    "export_to_optuna",
    "fit",
    "minimise_function",
    "open_study",
    "operating_map",
    "optimise",
    "optuna",
    "plots",
    "read_motor_file",
    "resume",
    "simulate",
    "simulate_to",
    "summarise",
    "sweep",
    "waveforms",
]


def __getattr__(name: str) -> Any:
    if name in ("optuna", "plots"):
        return import_module(f"camring.interfaces.{name}")
    if name not in _HOMES:
        raise AttributeError(f"module 'camring' has no attribute {name!r}")
    found = getattr(import_module(_HOMES[name]), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted(__all__)
