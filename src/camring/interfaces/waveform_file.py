"""Waveforms as one NetCDF file: what a chamber and the shaft do over one revolution.

The dataset has the dimensions `operating_point` and `angle` (rad of shaft);
each variable carries its unit and a name for people in its attributes, so the
file explains itself to xarray, MATLAB, ncdump or whatever comes.
"""

import os
import tempfile
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from math import pi
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from camring import __version__
from camring.interfaces.errors import InputError

if TYPE_CHECKING:
    import xarray

    from camring.physics.cycle import Cycle
    from camring.physics.system import System

__all__ = ["WAVEFORMS", "waveform_dataset", "write_waveforms"]

SAMPLES = 3600  # of one revolution: a tenth of a degree apart
_HDF5 = b"\x89HDF\r\n\x1a\n"

# Name -> unit as UDUNITS writes it, name for people.
WAVEFORMS: Mapping[str, tuple[str, str]] = {
    "lift": ("m", "piston lift"),
    "velocity": ("m s-1", "piston velocity, positive away from the shaft"),
    "acceleration": ("m s-2", "piston acceleration"),
    "jerk": ("m s-3", "piston jerk"),
    "volume": ("m3", "chamber volume"),
    "chamber_pressure": ("Pa", "chamber pressure, absolute"),
    "gallery_pressure": ("Pa", "pressure in the supply manifold, absolute; if there is one"),
    "supply_flow": ("m3 s-1", "flow into the chamber from the supply port"),
    "return_flow": ("m3 s-1", "flow into the chamber from the return port"),
    "leakage_flow": ("m3 s-1", "leakage out of the chamber"),
    "contact_force": ("N", "force between roller and ring, along their normal"),
    "contact_stress": ("Pa", "Hertz stress between roller and ring"),
    "torque": ("N m", "torque of the shaft, all pistons together"),
}

_DUTIES: Mapping[str, tuple[str, str]] = {
    "shaft_speed": ("rad s-1", "shaft speed"),
    "supply_pressure": ("Pa", "supply pressure, absolute"),
    "return_pressure": ("Pa", "return pressure, absolute"),
    "case_pressure": ("Pa", "case pressure, absolute"),
    "weight": ("1", "weight in the objective"),
}


def waveform_dataset(
    system: "System",
    cycles: Sequence["Cycle"],
    *,
    source: str = "",
    samples: int = SAMPLES,
) -> "xarray.Dataset":
    """The waveforms of one revolution at every operating point.

    Parameters
    ----------
    cycles
        One for each operating point of the system, in its order.
    source
        The motor file's text, kept in the attributes.
    samples
        Angles, evenly spaced from 0, the end of the revolution left out.
    """
    import equinox
    import jax.numpy as jnp
    import xarray

    from camring.physics.waveforms import waveforms

    sampled = equinox.filter_jit(waveforms)
    angle = 2 * pi * np.arange(samples) / samples
    waves = [sampled(cycle, jnp.asarray(angle)) for cycle in cycles]
    variables = {
        name: (
            ("operating_point", "angle"),
            np.stack([np.asarray(getattr(wave, name)) for wave in waves]),
            {"units": unit, "long_name": long_name},
        )
        for name, (unit, long_name) in WAVEFORMS.items()
        if all(getattr(wave, name) is not None for wave in waves)
    }
    duties = {
        name: (
            "operating_point",
            np.array([float(getattr(point, name)) for point in system.operating_points]),
            {"units": unit, "long_name": long_name},
        )
        for name, (unit, long_name) in _DUTIES.items()
    }
    coordinates = {
        "operating_point": (
            "operating_point",
            np.arange(1, len(waves) + 1),
            {"units": "1", "long_name": "number of the operating point in the motor file"},
        ),
        "angle": ("angle", angle, {"units": "rad", "long_name": "shaft angle"}),
        **duties,
    }
    return xarray.Dataset(variables, coordinates, _attributes(system, source))


def write_waveforms(
    path: str | Path,
    system: "System",
    cycles: Sequence["Cycle"],
    *,
    source: str = "",
    samples: int = SAMPLES,
) -> Path:
    """Write the waveforms to a NetCDF file, whole or not at all.

    Raises
    ------
    InputError
        When a file stands there that is no NetCDF file, or the place cannot be written.
    """
    place = Path(path)
    _require_replaceable(place)
    dataset = waveform_dataset(system, cycles, source=source, samples=samples)
    packed = {name: {"zlib": True, "complevel": 4} for name in dataset.data_vars}
    unfinished: Path | None = None
    try:
        handle, name = tempfile.mkstemp(prefix=f".{place.name}.", dir=place.parent)
        unfinished = Path(name)
        os.close(handle)
        dataset.to_netcdf(unfinished, engine="h5netcdf", encoding=packed)
        with open(unfinished, "rb") as written:
            os.fsync(written.fileno())
        unfinished.chmod(0o666 & ~_umask())
        unfinished.replace(place)
    except OSError as error:
        raise InputError(
            str(place),
            f"cannot be written ({error.strerror or error})",
            "choose a place where you may write and where there is room",
        ) from error
    finally:
        if unfinished is not None:
            unfinished.unlink(missing_ok=True)
    return place


def _attributes(system: "System", source: str) -> dict[str, object]:
    import jax

    motor = system.motor
    return {
        "title": f"Waveforms of {motor.name or 'a radial-piston motor'}",
        "pistons": motor.pistons,
        "lobes": motor.lobes,
        "source": f"camring {__version__}, jax {jax.__version__}",
        "history": f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ} written by camring {__version__}",
        "motor_file": source,
        "comment": "chamber variables belong to the piston that stands at the shaft angle",
    }


def _require_replaceable(place: Path) -> None:
    """A slip of the hand must not replace a motor file by waveforms."""
    if not place.parent.is_dir():
        raise InputError(str(place), "lies in no existing folder", "make the folder first")
    if place.is_dir():
        raise InputError(str(place), "is a folder", "give the name of a file, such as out.nc")
    if not place.exists():
        return
    try:
        with open(place, "rb") as file:
            start = file.read(len(_HDF5))
    except OSError as error:
        raise InputError(
            str(place), f"cannot be read ({error.strerror})", "choose another name"
        ) from error
    if start != _HDF5:
        raise InputError(
            str(place),
            "exists and is no NetCDF file that camring could have written",
            "give a new name, or remove that file yourself",
        )


def _umask() -> int:
    current = os.umask(0)
    os.umask(current)
    return current
