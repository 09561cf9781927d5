"""The table `[design_space.cam]`: smooth modes of the cam."""

from dataclasses import dataclass, field
from typing import Annotated as Key
from typing import Any, NamedTuple

import jax
import numpy as np
from pydantic import ValidationError

from camring.files.errors import InputError, quote
from camring.files.motor.entries import Count, Entry, Number, Numbers, Switch, Unfit
from camring.files.motor.keys import nearest
from camring.files.motor.tables import MotorTable, Table
from camring.objective.cam_modes import CamModes, control_values
from camring.physics.system import System

FIELD = "design_space.cam"
HARMONIC = Count("a harmonic of the lobe", "3", high=360)
SYMMETRIC = 1e-6  # of the range of the control values


class Amplitude(NamedTuple):
    """A length, or a share of the range of the given control values."""

    size: float
    share: bool


@dataclass(frozen=True)
class LengthOrShare(Entry):
    """`"2 mm"` or `"15 %"`."""

    length: Number = field(kw_only=True)
    share: Number = field(kw_only=True)

    def read(self, value: Any) -> Amplitude:
        if isinstance(value, str) and value.rstrip().endswith("%"):
            return Amplitude(self.share.read(value), True)
        return Amplitude(self.length.read(value), False)


@dataclass(frozen=True)
class Harmonics(Entry):
    """How many harmonics, or which."""

    def read(self, value: Any) -> int | list[int]:
        if not isinstance(value, list):
            return Count(self.meaning, self.example, high=360).read(value)
        harmonics = Numbers(self.meaning, self.example, item=HARMONIC).read(value)
        if len(set(harmonics)) < len(harmonics):
            raise Unfit(f"is {value}, with one harmonic twice"[:80], "name each once")
        return sorted(harmonics)


_MEANING = "the bound of a control value's change by harmonic 1, which falls as 1/k^2"


class CamModesTable(Table):
    """[design_space.cam]"""

    modes: Key[Any, Harmonics("the highest harmonic of the lobe that may change, or a list", "8")]
    amplitude: Key[
        Any,
        LengthOrShare(
            _MEANING,
            '"2 mm" or "20 %" (of the range of the control values)',
            length=Number(_MEANING, '"2 mm"', unit="m", low=1e-9, high=10.0),
            share=Number(_MEANING, '"20 %"', unit="1", low=1e-6, high=2.0),
        ),
    ]
    mirror: Key[bool, Switch("whether the cam stays symmetric about its dead centres", "true")] = (
        False
    )
    keep_displacement: Key[bool, Switch("whether the displacement stays as given", "true")] = True


def build_cam_modes(given: Any, motor: MotorTable, system: System) -> CamModes:
    """The cam's modes, around the given cam.

    Raises
    ------
    InputError
        For harmonics that the control values cannot carry, and amplitudes that could
        turn the ring inside out.
    """
    table = _table(given)
    lobes = motor.lobes if motor.cam.symmetry == "ring" else 1
    values = np.asarray(control_values(system.motor.cam))
    highest = len(values) // (2 * lobes)
    harmonics = _harmonics(table, highest)
    amplitude = table.amplitude.size * (np.ptp(values) if table.amplitude.share else 1.0)
    modes = CamModes(
        harmonics=harmonics,
        amplitude=amplitude,
        count=len(values),
        lobes=lobes,
        mirror=table.mirror,
        keep_displacement=table.keep_displacement,
    )
    reach = float(np.sum(jax.tree.map(np.asarray, modes).bounds()))
    if reach > 0.5 * values.min():
        raise InputError(
            f"{FIELD}.amplitude",
            f"lets control values change by {reach * 1e3:.4g} mm, more than half the smallest "
            f"radius of {values.min() * 1e3:.4g} mm",
            "give less",
        )
    if table.mirror:
        _require_symmetric(values)
    return modes


def _table(given: Any) -> CamModesTable:
    if not isinstance(given, dict):
        raise InputError(FIELD, f"is {quote(given)} but must be a table", f"write [{FIELD}]")
    try:
        return CamModesTable.model_validate(given)
    except ValidationError as error:
        order = {"extra_forbidden": 0, "missing": 2}
        fault = min(error.errors(), key=lambda each: order.get(each["type"], 1))
    key = str(fault["loc"][0])
    path = f"{FIELD}.{key if key.isidentifier() and len(key) < 60 else quote(key)}"
    if fault["type"] == "missing":
        (entry,) = (
            each for each in CamModesTable.model_fields[key].metadata if isinstance(each, Entry)
        )
        raise InputError(path, "is missing", entry.way_out)
    if fault["type"] == "extra_forbidden":
        known = list(CamModesTable.model_fields)
        close = nearest(key, known)
        way_out = f"you probably meant {close}" if close else "known are " + ", ".join(known)
        raise InputError(path, f"is not a key of [{FIELD}]", way_out)
    parts = fault["ctx"]
    raise InputError(path + parts["inside"], parts["problem"], parts["way_out"])


def _harmonics(table: CamModesTable, highest: int) -> tuple[int, ...]:
    first = 2 if table.keep_displacement else 1
    chosen = range(first, table.modes + 1) if isinstance(table.modes, int) else tuple(table.modes)
    field_name = f"{FIELD}.modes"
    if not chosen:
        raise InputError(
            field_name,
            "ends before harmonic 2, the first that changes the law of motion at a kept "
            "displacement",
            "give 3 or more, or set keep_displacement = false",
        )
    if max(chosen) > highest:
        raise InputError(
            field_name,
            f"asks for harmonic {max(chosen)} but the control values of a lobe carry at most "
            f"{highest}, half their number",
            "ask for less or give more control values",
        )
    if min(chosen) < first:
        raise InputError(
            field_name,
            "names harmonic 1, which at a kept displacement has no effect but a turn",
            "start at 2, or set keep_displacement = false",
        )
    return tuple(chosen)


def _require_symmetric(values: np.ndarray) -> None:
    mirrored = np.roll(values[::-1], 1)
    worst = int(np.argmax(np.abs(values - mirrored)))
    if abs(values[worst] - mirrored[worst]) > SYMMETRIC * np.ptp(values):
        other = (len(values) - worst) % len(values)
        raise InputError(
            f"{FIELD}.mirror",
            "is true but the given cam is not symmetric about angle 0: control values "
            f"{worst} and {other} are {values[worst] * 1e3:.6g} and {values[other] * 1e3:.6g} mm",
            "make them equal, or leave mirror out",
        )
