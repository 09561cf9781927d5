"""What may be asked for beside the motor file, as typed or in SI."""

from dataclasses import dataclass, field
from math import isfinite

from camring.exchange.drawings.ring_curves import DxfStyle
from camring.exchange.fmu.axes import Ranges
from camring.files.csv_table import Decimal
from camring.files.errors import InputError, quote
from camring.files.units import UnitError, to_si

__all__ = ["Wishes"]

DEFAULT_CHORD = 1e-6  # m


@dataclass(frozen=True)
class Wishes:
    """What may be asked for beside the motor file; lengths in m, None for the default."""

    chord: float = DEFAULT_CHORD
    port_circle: float | None = None
    outer_diameter: float | None = None
    ring_width: float | None = None
    table: Ranges = field(default_factory=Ranges)
    """Speeds and pressures of the FMU's table, as typed."""
    dxf: DxfStyle = field(default_factory=DxfStyle)
    decimal: Decimal = Decimal.POINT
    """What parts decimals in CSV files."""

    @classmethod
    def read(
        cls,
        chord: str | None = None,
        port_circle: str | None = None,
        outer_diameter: str | None = None,
        ring_width: str | None = None,
        table: Ranges | None = None,
        dxf: str | None = None,
        dxf_tolerance: str | None = None,
        decimal: Decimal = Decimal.POINT,
    ) -> "Wishes":
        """Wishes from what stands on the command line, such as "42 mm".

        Raises
        ------
        InputError
            For what is no length above zero, and for a style of DXF that is none.
        """
        return cls(
            _length("--chord", chord, "2 um") or DEFAULT_CHORD,
            _length("--port-circle", port_circle, "42 mm"),
            _length("--outer-diameter", outer_diameter, "280 mm"),
            _length("--ring-width", ring_width, "30 mm"),
            table or Ranges(),
            DxfStyle.of(dxf, _length("--dxf-tolerance", dxf_tolerance, "2 um")),
            decimal,
        )


def _length(option: str, text: str | None, example: str) -> float | None:
    if text is None:
        return None
    try:
        value = to_si(text, "m")
    except UnitError as error:
        raise InputError(option, str(error), f'give a length such as "{example}"') from None
    if not (isfinite(value) and 0 < value < 100):
        raise InputError(
            option,
            f"is {quote(text)} but must be above zero and below 100 m",
            f'give a length such as "{example}"',
        )
    return value
