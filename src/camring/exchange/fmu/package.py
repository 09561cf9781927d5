"""The FMU as one file: description, tables, sources and, where it can be made, a binary."""

import io
import uuid
import zipfile
from dataclasses import dataclass
from datetime import UTC, datetime
from hashlib import sha256
from html import escape

from camring.exchange.drawings.about import about
from camring.exchange.fmu.axes import BAR, RPM
from camring.exchange.fmu.compiler import Binary, compiled, source_texts
from camring.exchange.fmu.description import model_description, starts
from camring.exchange.fmu.filling import Filled
from camring.exchange.fmu.identity import identifier
from camring.exchange.fmu.table import QUANTITIES
from camring.files.motor import MotorFile

__all__ = ["Fmu", "fmu_of", "statements"]

_EPOCH = (1980, 1, 1, 0, 0, 0)  # the day before which no zip file can have been made


@dataclass(frozen=True)
class Fmu:
    """An FMU ready to be written, and the library in it."""

    name: str
    content: bytes
    binary: Binary

    @property
    def parts(self) -> str:
        """Which platforms it runs on as it is."""
        if self.binary.content:
            return f"{self.binary.path.split('/')[1]}, and sources for others"
        return (
            f"sources only, for {self.binary.why}; `fmpy compile {self.name}.fmu` adds a binary "
            "on a machine with a compiler and CMake"
        )


def fmu_of(file: MotorFile, filled: Filled) -> Fmu:
    """Puts together the FMU of a motor file from its filled table."""
    name, point = identifier(file), file.system.operating_points[0]
    table = filled.table.content()
    # Other tables, other identity: an importer then does not take one for the other.
    guid = f"{{{uuid.uuid5(uuid.NAMESPACE_OID, f'{name} {sha256(table).hexdigest()}')}}}"
    said = statements(file, filled)
    moment = f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ}"
    periods = filled.table.periods
    shown = " ".join(said[: 2 + len(QUANTITIES)])
    description = model_description(name, guid, shown, moment, point, periods)
    numbers = ", ".join(f"{value!r}" for value in starts(point))
    model = (
        "/* What is this motor's own. */\n"
        f'#define CAMRING_GUID "{guid}"\n#define CAMRING_START {{{numbers}}}\n'
    )
    sources = {**source_texts(), "camring_model.h": model}
    binary = compiled(sources, name)
    contents: dict[str, str | bytes] = {
        "modelDescription.xml": description,
        "documentation/index.html": _page(name, said),
        "resources/table.bin": table,
        **{f"sources/{each}": text for each, text in sources.items()},
    }
    if binary.content:
        contents[binary.path] = binary.content
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, content in contents.items():
            entry = zipfile.ZipInfo(path, _EPOCH)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if path == binary.path else 0o644) << 16
            archive.writestr(entry, content)
    return Fmu(name, packed.getvalue(), binary)


def statements(file: MotorFile, filled: Filled) -> list[str]:
    """What an importer should know, a sentence or two each: the same in every file."""
    table, errors = filled.table, filled.errors
    motor = about(file)
    speed, drop, low = table.axes
    return [
        f"{motor.motor}, quasi-steady: the periodic cycle of constant speed and pressures, "
        f"looked up at every instant; no lines, no inertia. From {motor.file}, sha256 "
        f"{motor.digest}, by {motor.program}.",
        f"Table error half-way between the table's points and angles, worst of {errors.places} "
        "places, in shares of the largest absolute value:",
        *(f"- {each}" for each in errors.sentences()),
        f"Speeds from {speed[0] / RPM:.4g} to {speed[-1] / RPM:.4g} rpm, pressure drops from "
        f"{drop[0] / BAR:.4g} to {drop[-1] / BAR:.4g} bar, the lower port from {low[0] / BAR:.4g} "
        f"to {low[-1] / BAR:.4g} bar above the case: {table.points} points of "
        f"{table.waves.shape[-1]} angles in each of {table.periods} periods of a revolution. "
        "Beyond, inputs are held at the edge, which is reported once.",
        f"Flows are volumes at the density of the higher port pressure; the case stood at "
        f"{filled.case_pressure / BAR:.4g} bar absolute when the table was made.",
        *filled.warnings,
    ]


def _page(name: str, said: list[str]) -> str:
    paragraphs = "\n".join(f"<p>{escape(each)}</p>" for each in said)
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{name}</title></head>'
        f"<body>\n<h1>{name}</h1>\n{paragraphs}\n</body></html>\n"
    )
