"""What a report shows, as plain records of numbers and text.

Everything is SI and absolute pressure, as everywhere inside; the pictures and
tables convert. Nothing here knows a motor file, a database or JAX, so a report
can be drawn from any source that fills these records.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from camring.files.point_names import name_of
from camring.presentation.envelope import WholeEnvelope

__all__ = [
    "Check",
    "Constraint",
    "Design",
    "Facts",
    "Point",
    "Profile",
    "Provenance",
    "ReportData",
    "Result",
    "Search",
    "Sensitivity",
    "Start",
    "Trial",
    "Variable",
    "Verdict",
    "View",
    "Waves",
]


@dataclass(frozen=True)
class Point:
    """One operating point."""

    shaft_speed: float  # rad/s
    supply_pressure: float  # Pa
    return_pressure: float  # Pa
    case_pressure: float  # Pa
    weight: float = 1.0
    reverse: bool = False
    mode: str = ""

    @property
    def pressure_drop(self) -> float:
        return self.supply_pressure - self.return_pressure

    @property
    def name(self) -> str:
        """Short name in shop-floor units, such as "300 rpm, 250 bar, reverse"."""
        return name_of(self)


@dataclass(frozen=True)
class Facts:
    """Numbers of the hardware that the pictures need."""

    pistons: int
    lobes: int
    repeats: int  # how often the ring repeats a revolution: lobes, or 1 when free
    bore: float  # m
    roller_radius: float  # m
    surviving_order: int
    distinct_phases: int


@dataclass(frozen=True)
class Profile:
    """The cam over one of its periods; arrays share the shape (angle,)."""

    angle: np.ndarray  # rad, from 0 to the period, both ends
    radius: np.ndarray  # m, of the pitch curve
    slope: np.ndarray  # m/rad
    curvature: np.ndarray  # 1/m, of the pitch curve
    pressure_angle: np.ndarray  # rad
    undercut_factor: np.ndarray


@dataclass(frozen=True)
class Waves:
    """One chamber and the shaft over one period of the cam; arrays of shape (angle,)."""

    angle: np.ndarray  # rad of shaft
    lift: np.ndarray  # m
    velocity: np.ndarray  # m/s
    acceleration: np.ndarray  # m/s2
    jerk: np.ndarray  # m/s3
    volume: np.ndarray  # m3
    chamber_pressure: np.ndarray  # Pa
    supply_flow: np.ndarray  # m3/s
    return_flow: np.ndarray  # m3/s
    leakage_flow: np.ndarray  # m3/s
    contact_force: np.ndarray  # N
    contact_stress: np.ndarray  # Pa
    torque: np.ndarray  # N m, of the shaft, all pistons
    supply_opening: np.ndarray  # share of the port area
    return_opening: np.ndarray


@dataclass(frozen=True)
class Start:
    """Torque at standstill over the angle after which it repeats; arrays of shape (angle,)."""

    angle: np.ndarray  # rad of shaft
    torque: np.ndarray  # N m, the way the operating point turns
    backwards: np.ndarray  # N m, the other way; positive where the shaft starts
    ideal_torque: float  # N m


@dataclass(frozen=True)
class Result:
    """One design at one operating point."""

    point: Point
    metrics: Mapping[str, float]
    waves: Waves
    orders: np.ndarray  # shaft orders, ascending
    torque_amplitudes: np.ndarray  # N m, peak value of each order
    flow_amplitudes: np.ndarray  # m3/s, of the supply flow of all pistons
    periodicity_residual: float = float("nan")
    numerical_error: float = float("nan")
    start: Start | None = None


@dataclass(frozen=True)
class Design:
    """One motor, simulated at every operating point."""

    label: str
    facts: Facts
    profile: Profile
    results: tuple[Result, ...]


@dataclass(frozen=True)
class Constraint:
    """One limit with its value and margin in every design, worst over the operating points.

    `margins` are `-g` of docs/theory.md section 8: dimensionless, positive when kept.
    """

    name: str
    limit: str
    values: tuple[str, ...]
    margins: tuple[float, ...]
    bound: float = float("nan")  # SI, where the limit is a single number


@dataclass(frozen=True)
class Check:
    """One thing that validation looked at."""

    name: str
    passed: bool
    detail: str


@dataclass(frozen=True)
class View:
    """A design as one solver sees it; results are weighted means over the operating points."""

    design: str
    eye: str
    objective: float
    torque_ripple: float
    efficiency: float
    margin: float  # the tightest


@dataclass(frozen=True)
class Verdict:
    """Whether the claims hold when they are looked at twice."""

    validated: bool
    sentence: str
    checks: tuple[Check, ...] = ()
    views: tuple[View, ...] = ()


@dataclass(frozen=True)
class Variable:
    """One number the search was allowed to change, in the unit of the file."""

    name: str
    unit: str
    low: float
    high: float
    values: tuple[float, ...]  # one for each design


@dataclass(frozen=True)
class Trial:
    """One evaluated design."""

    number: int
    phase: str
    objective: float  # NaN when the evaluation failed
    feasible: bool
    failed: bool = False
    variables: Mapping[str, float] = field(default_factory=dict)
    results: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Search:
    """How the best design was found."""

    trials: tuple[Trial, ...]
    stopped: str = ""
    # Surrogate name -> leave-one-out error; the one used is named.
    leave_one_out: Mapping[str, float] = field(default_factory=dict)
    surrogate_used: str = ""
    notes: tuple[str, ...] = ()
    given: int | None = None  # number of the trial of the given motor
    best: int | None = None


@dataclass(frozen=True)
class Sensitivity:
    """What one variable does to one result when moved down and up from the best design."""

    variable: str
    result: str
    low: float
    high: float
    centre: float
    step: str


@dataclass(frozen=True)
class Provenance:
    """Enough to repeat the work: what went in, with what, when."""

    input_name: str
    input_text: str
    best_text: str = ""
    versions: Mapping[str, str] = field(default_factory=dict)
    settings: Mapping[str, str] = field(default_factory=dict)
    date: str = ""


@dataclass(frozen=True)
class ReportData:
    """Everything a report shows. One design, a given and a best one, or several to compare."""

    title: str
    designs: tuple[Design, ...]
    provenance: Provenance
    subtitle: str = ""
    verdict: Verdict | None = None
    constraints: tuple[Constraint, ...] = ()
    variables: tuple[Variable, ...] = ()
    search: Search | None = None
    sensitivities: tuple[Sensitivity, ...] = ()
    warnings: tuple[str, ...] = ()
    envelope: WholeEnvelope | None = None

    @property
    def is_study(self) -> bool:
        """Whether there is a given and a best design to tell apart."""
        return self.search is not None and len(self.designs) == 2
