"""Waveforms over one revolution, and the results beside them, as a file of several kinds.

The dataset has the dimensions `operating_point` and `angle` (rad of shaft);
each variable carries its unit and a name for people in its attributes. The
name's ending says the kind: `.nc` (NetCDF) and `.mat` (MATLAB) hold SI for
programs, `.csv` and `.xlsx` an engineer's units for people.
"""

import io
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from math import pi
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from camring.exchange.waveforms.attributes import attributes_of, works_as
from camring.exchange.waveforms.units import RESULT
from camring.files.csv_table import Decimal
from camring.files.errors import InputError, quote
from camring.files.motor.document import printable
from camring.files.whole_file import draft_beside, put_in_place

if TYPE_CHECKING:
    import xarray

    from camring.physics.cycle import Cycle
    from camring.physics.system import System

__all__ = [
    "ENDINGS",
    "RESULT",
    "WAVEFORMS",
    "places_of",
    "require_known_ending",
    "waveform_dataset",
    "write_simulation",
    "write_waveforms",
]

SAMPLES = 3600  # of one revolution: a tenth of a degree apart

# Name -> unit as UDUNITS writes it, name for people.
WAVEFORMS: Mapping[str, tuple[str, str]] = {
    "lift": ("m", "piston lift"),
    "velocity": ("m s-1", "piston velocity, positive away from the shaft"),
    "acceleration": ("m s-2", "piston acceleration"),
    "jerk": ("m s-3", "piston jerk"),
    "volume": ("m3", "chamber volume"),
    "chamber_pressure": ("Pa", "chamber pressure, absolute"),
    "manifold_pressure": ("Pa", "pressure in the supply manifold, absolute; if there is one"),
    "return_manifold_pressure": ("Pa", "pressure in the return manifold, absolute; likewise"),
    "supply_flow": ("m3 s-1", "flow into the chamber from the supply port"),
    "return_flow": ("m3 s-1", "flow into the chamber from the return port"),
    "leakage_flow": ("m3 s-1", "leakage out of the chamber"),
    "contact_force": ("N", "force between roller and ring, along their normal"),
    "contact_stress": ("Pa", "Hertz stress between roller and ring"),
    "torque": ("N m", "torque of the shaft, all pistons together"),
}

_CONDITIONS: Mapping[str, tuple[str, str]] = {
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
    results: Sequence[Mapping[str, float]] = (),
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
    results
        Those of docs/theory.md section 10 for each operating point, SI; kept when given.
    """
    import jax.numpy as jnp
    import xarray

    from camring.programs.compiled import waveforms

    angle = 2 * pi * np.arange(samples) / samples
    waves = [waveforms(cycle, jnp.asarray(angle)) for cycle in cycles]
    variables = {
        name: (
            ("operating_point", "angle"),
            np.stack([np.asarray(getattr(wave, name)) for wave in waves]),
            {"units": unit, "long_name": long_name},
        )
        for name, (unit, long_name) in WAVEFORMS.items()
        if all(getattr(wave, name) is not None for wave in waves)
    }
    conditions = {
        name: (
            "operating_point",
            np.array([float(getattr(point, name)) for point in system.operating_points]),
            {"units": unit, "long_name": long_name},
        )
        for name, (unit, long_name) in _CONDITIONS.items()
    }
    coordinates = {
        "operating_point": (
            "operating_point",
            np.arange(1, len(waves) + 1),
            {"units": "1", "long_name": "number of the operating point in the motor file"},
        ),
        "angle": ("angle", angle, {"units": "rad", "long_name": "shaft angle"}),
        **conditions,
    }
    attributes = {**attributes_of(system, source), **works_as(results)}
    return xarray.Dataset({**variables, **_results(results)}, coordinates, attributes)


def _results(results: Sequence[Mapping[str, float]]) -> dict[str, tuple]:
    from camring.exchange.waveforms.units import result_units
    from camring.files.quantities import QUANTITIES

    units = result_units()
    found = {}
    for name in results[0] if results else ():
        label = QUANTITIES[name].label if name in QUANTITIES else name.replace("_", " ")
        values = np.array([float(each[name]) for each in results])
        attributes = {"units": units.get(name, "1"), "long_name": label}
        found[RESULT + name] = ("operating_point", values, attributes)
    return found


def write_waveforms(
    path: str | Path,
    system: "System",
    cycles: Sequence["Cycle"],
    *,
    source: str = "",
    samples: int = SAMPLES,
) -> Path:
    """Write the waveforms to a file of the kind its ending says, whole or not at all.

    Raises
    ------
    InputError
        When the ending is unknown, an extra is missing, a file of another kind
        stands there, or the place cannot be written.
    """
    return write_simulation(path, system, cycles, (), source=source, samples=samples)[0]


def write_simulation(
    path: str | Path,
    system: "System",
    cycles: Sequence["Cycle"],
    results: Sequence[Mapping[str, float]],
    *,
    source: str = "",
    samples: int = SAMPLES,
    decimal: Decimal = Decimal.POINT,
) -> list[Path]:
    """Write waveforms and results; the files written.

    One file holds both, but a CSV file has one table: results then stand in
    another beside it, `out_results.csv` for `out.csv`.

    Parameters
    ----------
    decimal
        What parts decimals in CSV.

    Raises
    ------
    InputError
        As `write_waveforms`.
    """
    places = places_of(path, with_results=bool(results))
    kind = _KINDS[places[0].suffix.lower()]
    dataset = waveform_dataset(system, cycles, source=source, samples=samples, results=results)
    for number, each in enumerate(places):
        writer = kind.writers[number]
        if kind.name == "CSV":
            writer = partial(writer, decimal=decimal)
        _write_whole(each, writer, dataset)
    return places


def places_of(path: str | Path, *, with_results: bool = True) -> list[Path]:
    """Every file that a name stands for, each known to be writable now.

    Raises
    ------
    InputError
        As `write_waveforms`, but for a missing extra.
    """
    place = Path(path)
    require_known_ending(place)
    places = [place]
    if place.suffix.lower() == ".csv" and with_results:
        places.append(place.with_name(f"{place.stem}_results{place.suffix}"))
    for each in places:
        _require_replaceable(each, _KINDS[place.suffix.lower()])
    return places


def require_known_ending(path: Path) -> None:
    """Raises `InputError` for a file name whose ending is no kind of waveform file."""
    if path.is_dir():
        raise InputError(str(path), "is a folder", "give the name of a file, such as out.nc")
    if path.suffix.lower() not in _KINDS:
        ending = f"ends in {quote(path.suffix)}" if path.suffix else "has no ending"
        raise InputError(
            printable(path),
            f"{ending}, which is no kind of waveform file",
            f"end its name in one of {', '.join(_KINDS)}",
        )


def _write_whole(
    place: Path, writer: Callable[["xarray.Dataset", Path], None], dataset: "xarray.Dataset"
) -> None:
    try:
        with draft_beside(place) as draft:
            writer(dataset, draft)
            put_in_place(draft, place)
    except _refusals() as error:
        number = getattr(error, "errno", None)  # h5py's own words are five lines
        reason = os.strerror(number) if number else " ".join(str(error).split())
        raise InputError(
            printable(place),
            f"cannot be written ({reason})",
            "choose a place where you may write and where there is room",
        ) from error


def _refusals() -> tuple[type[Exception], ...]:
    """What the system, h5py and XlsxWriter raise where a file cannot be written."""
    try:
        from xlsxwriter.exceptions import XlsxWriterException
    except ImportError:
        return OSError, RuntimeError
    return OSError, RuntimeError, XlsxWriterException


@dataclass(frozen=True)
class _Kind:
    """A kind of file: what people call it, how it begins, who writes it."""

    name: str
    start: bytes
    writers: tuple[Callable[..., None], ...]


def _write_netcdf(dataset: "xarray.Dataset", place: Path) -> None:
    packed = {name: {"zlib": True, "complevel": 4} for name in WAVEFORMS if name in dataset}
    # Where a disk takes no more in the middle of a file, HDF5 ends the process by a signal.
    memory = io.BytesIO()
    dataset.to_netcdf(memory, engine="h5netcdf", encoding=packed)
    place.write_bytes(memory.getvalue())


def _write_matlab(dataset: "xarray.Dataset", place: Path) -> None:
    from camring.exchange.waveforms.tables import write_matlab

    write_matlab(dataset, place)


def _write_csv(dataset: "xarray.Dataset", place: Path, decimal: Decimal = Decimal.POINT) -> None:
    from camring.exchange.waveforms.tables import write_csv

    write_csv(dataset, place, decimal)


def _write_results_csv(
    dataset: "xarray.Dataset", place: Path, decimal: Decimal = Decimal.POINT
) -> None:
    from camring.exchange.waveforms.tables import write_results_csv

    write_results_csv(dataset, place, decimal)


def _write_excel(dataset: "xarray.Dataset", place: Path) -> None:
    from camring.exchange.waveforms.workbook import write_workbook

    write_workbook(dataset, place)


_KINDS: Mapping[str, _Kind] = {
    ".nc": _Kind("NetCDF", b"\x89HDF\r\n\x1a\n", (_write_netcdf,)),
    ".csv": _Kind("CSV", b"# Waveforms of", (_write_csv, _write_results_csv)),
    ".xlsx": _Kind("XLSX", b"PK\x03\x04", (_write_excel,)),
    ".mat": _Kind("MAT", b"MATLAB 5.0", (_write_matlab,)),
}
ENDINGS = tuple(_KINDS)


def _require_replaceable(place: Path, kind: _Kind) -> None:
    """A slip of the hand must not replace a motor file by waveforms."""
    if not place.parent.is_dir():
        raise InputError(str(place), "lies in no existing folder", "make the folder first")
    if not os.access(place.parent, os.W_OK):
        raise InputError(str(place), "lies in a folder that is read-only", "choose another place")
    if not place.exists():
        return
    try:
        with open(place, "rb") as file:
            start = file.read(len(kind.start))
    except OSError as error:
        raise InputError(
            str(place), f"cannot be read ({error.strerror})", "choose another name"
        ) from error
    if start != kind.start:
        raise InputError(
            str(place),
            f"exists and is no {kind.name} file that camring could have written",
            "give a new name, or remove that file yourself",
        )
