"""Better cam rings and valve timing for radial-piston hydraulic motors.

Everything here is loaded when it is first asked for, so that `import camring`
and `camring --help` cost nothing.

>>> import camring
>>> motor_file = camring.read_motor_file("motor.toml")
>>> camring.simulate(motor_file)  # one cycle for each operating point
(Cycle: 8 pistons, 6 lobes; 100 rpm, supply 250 bar, return 10 bar; sound,)
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from camring.version import __version__

if TYPE_CHECKING:
    from camring import plots
    from camring.analyses.operating_map import operating_map
    from camring.analyses.quadrants import quadrants
    from camring.analyses.sweep import sweep
    from camring.api import Gradients, gradients, simulate, summarise
    from camring.evaluation.batch import evaluate_many
    from camring.evaluation.executors import Workers
    from camring.exchange import optuna
    from camring.exchange.optuna import export_to_optuna
    from camring.files.errors import InputError
    from camring.files.motor import MotorFile, read_motor_file
    from camring.fitting.fit import Fit, fit
    from camring.geometry.cam import PlanarCam, RadialCam
    from camring.geometry.material import Material
    from camring.geometry.notch import ReliefNotch
    from camring.geometry.piston import Piston, ReturnSpring, Roller
    from camring.geometry.valve_plate import Port, ValvePlate
    from camring.geometry.window import LinearWindow, RoundWindow, TabulatedWindow
    from camring.metrics.summary import Metrics
    from camring.objective.constraints import Constraints
    from camring.objective.design_space import DesignSpace
    from camring.objective.objective import Goal
    from camring.objective.terms import Weights
    from camring.physics.cycle import Cycle
    from camring.physics.friction import ViscousFriction
    from camring.physics.gap import PistonGap, PlateGap
    from camring.physics.heat.thermal import Thermal
    from camring.physics.leakage import ConstantLeakage, ViscousLeakage
    from camring.physics.manifold.manifold import Manifold
    from camring.physics.motor import Motor
    from camring.physics.oil.aerated_fluid import AeratedFluid
    from camring.physics.oil.churning import Churning
    from camring.physics.oil.fluid import ConstantFluid
    from camring.physics.oil.viscosity_line import ViscosityLine
    from camring.physics.operating_point import OperatingPoint
    from camring.physics.orifice import LaminarTurbulentOrifice, TurbulentOrifice
    from camring.physics.resolution import Resolution
    from camring.physics.stribeck_friction import StribeckFriction
    from camring.physics.system import System
    from camring.programs.compiled import evaluate, simulate_to, waveforms
    from camring.studies.study import Study, open_study
    from camring.studies.user_function import FunctionMinimum, minimise_function
    from camring.workflows.optimisation import optimise, resume

_PACKAGES = {"optuna": "camring.exchange.optuna", "plots": "camring.plots"}

_HOMES = {
    "AeratedFluid": "camring.physics.oil.aerated_fluid",
    "Churning": "camring.physics.oil.churning",
    "ConstantFluid": "camring.physics.oil.fluid",
    "ConstantLeakage": "camring.physics.leakage",
    "Constraints": "camring.objective.constraints",
    "Cycle": "camring.physics.cycle",
    "DesignSpace": "camring.objective.design_space",
    "Fit": "camring.fitting.fit",
    "FunctionMinimum": "camring.studies.user_function",
    "Goal": "camring.objective.objective",
    "Gradients": "camring.api",
    "InputError": "camring.files.errors",
    "LaminarTurbulentOrifice": "camring.physics.orifice",
    "LinearWindow": "camring.geometry.window",
    "Manifold": "camring.physics.manifold.manifold",
    "Material": "camring.geometry.material",
    "Metrics": "camring.metrics.summary",
    "Motor": "camring.physics.motor",
    "MotorFile": "camring.files.motor",
    "OperatingPoint": "camring.physics.operating_point",
    "Piston": "camring.geometry.piston",
    "PistonGap": "camring.physics.gap",
    "PlanarCam": "camring.geometry.cam",
    "PlateGap": "camring.physics.gap",
    "Port": "camring.geometry.valve_plate",
    "RadialCam": "camring.geometry.cam",
    "ReliefNotch": "camring.geometry.notch",
    "Resolution": "camring.physics.resolution",
    "ReturnSpring": "camring.geometry.piston",
    "Roller": "camring.geometry.piston",
    "RoundWindow": "camring.geometry.window",
    "Study": "camring.studies.study",
    "StribeckFriction": "camring.physics.stribeck_friction",
    "System": "camring.physics.system",
    "TabulatedWindow": "camring.geometry.window",
    "Thermal": "camring.physics.heat.thermal",
    "TurbulentOrifice": "camring.physics.orifice",
    "ValvePlate": "camring.geometry.valve_plate",
    "ViscosityLine": "camring.physics.oil.viscosity_line",
    "ViscousFriction": "camring.physics.friction",
    "ViscousLeakage": "camring.physics.leakage",
    "Weights": "camring.objective.terms",
    "Workers": "camring.evaluation.executors",
    "evaluate": "camring.programs.compiled",
    "evaluate_many": "camring.evaluation.batch",
    "export_to_optuna": "camring.exchange.optuna",
    "fit": "camring.fitting.fit",
    "gradients": "camring.api",
    "minimise_function": "camring.studies.user_function",
    "open_study": "camring.studies.study",
    "operating_map": "camring.analyses.operating_map",
    "quadrants": "camring.analyses.quadrants",
    "optimise": "camring.workflows.optimisation",
    "read_motor_file": "camring.files.motor",
    "resume": "camring.workflows.optimisation",
    "simulate": "camring.api",
    "simulate_to": "camring.programs.compiled",
    "summarise": "camring.api",
    "sweep": "camring.analyses.sweep",
    "waveforms": "camring.programs.compiled",
}

__all__ = [
    "AeratedFluid",
    "Churning",
    "ConstantFluid",
    "ConstantLeakage",
    "Constraints",
    "Cycle",
    "DesignSpace",
    "Fit",
    "FunctionMinimum",
    "Goal",
    "Gradients",
    "InputError",
    "LaminarTurbulentOrifice",
    "LinearWindow",
    "Manifold",
    "Material",
    "Metrics",
    "Motor",
    "MotorFile",
    "OperatingPoint",
    "Piston",
    "PistonGap",
    "PlanarCam",
    "PlateGap",
    "Port",
    "RadialCam",
    "ReliefNotch",
    "Resolution",
    "ReturnSpring",
    "Roller",
    "RoundWindow",
    "StribeckFriction",
    "Study",
    "System",
    "TabulatedWindow",
    "Thermal",
    "TurbulentOrifice",
    "ValvePlate",
    "ViscosityLine",
    "ViscousFriction",
    "ViscousLeakage",
    "Weights",
    "Workers",
    "__version__",
    "evaluate",
    "evaluate_many",
    "export_to_optuna",
    "fit",
    "gradients",
    "minimise_function",
    "open_study",
    "operating_map",
    "optimise",
    "optuna",
    "plots",
    "quadrants",
    "read_motor_file",
    "resume",
    "simulate",
    "simulate_to",
    "summarise",
    "sweep",
    "waveforms",
]


def __getattr__(name: str) -> Any:
    if name in _PACKAGES:
        return import_module(_PACKAGES[name])
    if name not in _HOMES:
        raise AttributeError(f"module 'camring' has no attribute {name!r}")
    found = getattr(import_module(_HOMES[name]), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted(__all__)
