"""The table `[envelope]`: where the motor must run, beside its operating points."""

from typing import Annotated as Key
from typing import Any

from camring.files.errors import InputError, ordinal, quote
from camring.files.motor.document import at_temperature
from camring.files.motor.entries import Band, Number, Word, band
from camring.files.motor.table import Table, pressure_entry
from camring.physics.envelope import Envelope, Range
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.oil.presets import COLDEST, HOTTEST, ZERO_CELSIUS
from camring.physics.system import System


def _between(meaning: str, example: str, item: Number) -> Band:
    entry = band(item)
    return Band(f"the range of {meaning}", example, item=entry.item, fewest=2, most=2)


_SPEED = Number("a shaft speed", '"30 rpm"', unit="rad/s", low=1e-4, high=1e4)
_TEMPERATURE = Number("an oil temperature", '"20 degC"', unit="K", low=230.0, high=420.0)


class EnvelopeTable(Table):
    """[envelope]"""

    speed: Key[
        tuple[float, float],
        _between("shaft speed in which every limit holds", '["30 rpm", "300 rpm"]', _SPEED),
    ]
    supply_pressure: Key[
        tuple[float, float],
        _between(
            "absolute supply pressure in which every limit holds",
            '["70 bar", "350 bar"]',
            pressure_entry("an absolute supply pressure", '"70 bar"'),
        ),
    ]
    return_pressure: Key[
        tuple[float, float] | None,
        _between(
            "absolute return pressure (unless given, that of the operating points)",
            '["8 bar", "20 bar"]',
            pressure_entry("an absolute return pressure", '"8 bar"'),
        ),
    ] = None
    temperature: Key[
        tuple[float, float] | None,
        _between(
            "oil temperature (unless given, that of [fluid])",
            '["20 degC", "80 degC"]',
            _TEMPERATURE,
        ),
    ] = None
    rotation: Key[
        str,
        Word(
            "whether it must run one way or both; backwards the ports are exchanged",
            '"both"',
            words=("forward", "both"),
        ),
    ] = "forward"
    max_ripple_ratio: Key[
        float | None,
        Number(
            "the limit of the torque ripple over the given motor's at the same point of the "
            "envelope",
            "1",
            low=1e-6,
            high=1e6,
        ),
    ] = None
    max_efficiency_loss: Key[
        float | None,
        Number(
            "the limit of what the efficiency may fall below the given motor's at the same "
            "point of the envelope",
            '"0.5 %"',
            low=0.0,
            high=1.0,
        ),
    ] = None


def build_envelope(
    table: EnvelopeTable, document: dict[str, Any], system: System, fluids: list[AbstractFluid]
) -> Envelope:
    """The envelope of a file.

    Parameters
    ----------
    document
        The file, for messages in its own words.
    fluids
        The oil at each end of `temperature`, where the table has one.

    Raises
    ------
    InputError
        For a supply pressure not above the return pressure.
    """
    given = document["envelope"]
    back = table.return_pressure or _of_operating_points(system)
    if table.supply_pressure[0] <= back[1]:
        raise InputError(
            "envelope.supply_pressure",
            f"begins at {quote(given['supply_pressure'][0])}, not above the return pressure of "
            f"{back[1] / 1e5:.4g} bar",
            "raise it or lower envelope.return_pressure; both are absolute",
        )
    if table.rotation == "both" and system.motor.valve_plate.notched:
        raise InputError(
            "envelope.rotation",
            'is "both", but a relief notch lies at the opening edge of its window, and '
            "backwards that edge closes, which the model does not have",
            'leave the notch out of [motor.valve_plate], or say rotation = "forward"',
        )
    return Envelope(
        speed=table.speed,
        supply_pressure=table.supply_pressure,
        return_pressure=back,
        case_pressure=_case(system),
        both_directions=table.rotation == "both",
        fluids=tuple(fluids),
        temperatures=table.temperature or (),
        ripple_ratio=table.max_ripple_ratio,
        efficiency_loss=table.max_efficiency_loss,
    )


def documents_at_temperatures(
    table: EnvelopeTable, document: dict[str, Any]
) -> list[dict[str, Any]]:
    """The file with its oil at each end of the envelope's temperature; none without one.

    Raises
    ------
    InputError
        Without a named oil, whose data alone follow a temperature, or outside its data.
    """
    if table.temperature is None:
        return []
    fluid = document.get("fluid", {})
    if "oil" not in fluid:
        raise InputError(
            "envelope.temperature",
            "has no effect without fluid.oil",
            'leave it out, or name an oil: oil = "ISO VG 46" in [fluid]',
        )
    for place, temperature in enumerate(table.temperature):
        if not COLDEST <= temperature <= HOTTEST:
            raise InputError(
                f"envelope.temperature, {ordinal(place + 1)} value",
                f"is {quote(document['envelope']['temperature'][place])}, outside the data of "
                f"{quote(fluid['oil'])}",
                f"give values from {COLDEST - ZERO_CELSIUS:g} to {HOTTEST - ZERO_CELSIUS:g} degC",
            )
    return [at_temperature(document, each) for each in table.temperature]


def _of_operating_points(system: System) -> Range:
    """An envelope is one of driving: of a point that brakes the low side counts, its supply."""
    given = [float(point.lower_pressure) for point in system.operating_points]
    return min(given), max(given)


def _case(system: System) -> float | None:
    """The highest case pressure of the operating points; None where it is the return's."""
    points = system.operating_points
    if all(float(each.case_pressure) == float(each.return_pressure) for each in points):
        return None
    return max(float(point.case_pressure) for point in points)
