"""Oils by their trade name: what a file may leave out about a common fluid.

Typical values, for a start; a maker's data sheet is better and every key of
the file overrides them. Sources:

- Viscosity at 40 C: ISO 3448 grades. At 100 C: mineral oils of class HM with a
  viscosity index near 100 (ISO 11158 asks for 90 or more), water-glycol HFC
  with an index near 200 (ISO 12922 fluids; makers' sheets give 190 to 220).
- Between them: Walther's equation, ASTM D341, `log log (v + 0.7) = A - B log T`.
- Bulk modulus of mineral oil: Hodges, Hydraulic Fluids (1996), isentropic, at
  atmospheric pressure, `(1.57 + 0.15 log10 v20) 10^(0.0024 (20 - t))` GPa with
  `v20` the viscosity at 20 C in mm2/s and `t` in C. Water-glycol: 3.3 GPa at
  20 C with the same share of loss with temperature as in makers' sheets, small.
- Density at 15 C and thermal expansion 7e-4 / K (mineral), 6.5e-4 / K (HFC):
  typical of data sheets.
- Vapour pressure: mineral oil below 1 Pa at 20 C (safety data sheets),
  doubling every 10 K; HFC four fifths of water's (Magnus form, WMO 2008), the
  molar share of about 43 % of water by mass.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import exp, log10

ZERO_CELSIUS = 273.15


@dataclass(frozen=True)
class OilData:
    """What the fluid laws ask of an oil at one temperature, SI."""

    density: float
    bulk_modulus: float
    vapour_pressure: float
    viscosity: float


@dataclass(frozen=True)
class _Oil:
    viscosity_40: float  # mm2/s
    viscosity_100: float  # mm2/s
    density_15: float  # kg/m3
    expansion: float  # 1/K
    bulk_modulus: Callable[[float, float], float]  # of (temperature in C, viscosity at 20 C)
    vapour_pressure: Callable[[float], float]  # Pa, of the temperature in C


def walther_viscosity(temperature: float, at_40: float, at_100: float) -> float:
    """Kinematic viscosity in the unit of the two given, mm2/s, at a temperature in K.

    ASTM D341 in its form for viscosities above 2 mm2/s; holds from the cloud
    point to about 150 C.
    """
    height, fall = walther_numbers(at_40, at_100)
    return 10 ** (10 ** (height - fall * log10(temperature))) - 0.7


def walther_numbers(at_40: float, at_100: float) -> tuple[float, float]:
    """`A` and `B` of `log log (v + 0.7) = A - B log T` through two viscosities in mm2/s."""

    def double_log(viscosity: float) -> float:
        return log10(log10(viscosity + 0.7))

    cool, hot = log10(ZERO_CELSIUS + 40), log10(ZERO_CELSIUS + 100)
    fall = (double_log(at_40) - double_log(at_100)) / (hot - cool)
    return double_log(at_40) + fall * cool, fall


def _mineral_modulus(celsius: float, viscosity_20: float) -> float:
    return 1e9 * (1.57 + 0.15 * log10(viscosity_20)) * 10 ** (0.0024 * (20 - celsius))


def _mineral_vapour(celsius: float) -> float:
    return 1.0 * 2 ** ((celsius - 20) / 10)


def _glycol_modulus(celsius: float, viscosity_20: float) -> float:
    return 3.3e9 * (1 - 0.003 * (celsius - 20))


def _glycol_vapour(celsius: float) -> float:
    return 0.8 * 611.2 * exp(17.62 * celsius / (243.12 + celsius))


_OILS = {
    "ISO VG 32": _Oil(32, 5.4, 872, 7e-4, _mineral_modulus, _mineral_vapour),
    "ISO VG 46": _Oil(46, 6.8, 877, 7e-4, _mineral_modulus, _mineral_vapour),
    "ISO VG 68": _Oil(68, 8.7, 882, 7e-4, _mineral_modulus, _mineral_vapour),
    "water-glycol": _Oil(46, 9.6, 1080, 6.5e-4, _glycol_modulus, _glycol_vapour),
}

OILS = tuple(_OILS)
"""Names a file may give."""

COLDEST, HOTTEST = ZERO_CELSIUS - 20, ZERO_CELSIUS + 110
"""Where the data hold, K."""


def line_numbers(name: str) -> tuple[float, float]:
    """The numbers of Walther's equation for an oil of this name, as `walther_numbers`.

    Raises
    ------
    KeyError
        For a name that is not in `OILS`.
    """
    oil = _OILS[name]
    return walther_numbers(oil.viscosity_40, oil.viscosity_100)


def oil_data(name: str, temperature: float) -> OilData:
    """Typical data of an oil of this name at a temperature in K.

    Raises
    ------
    KeyError
        For a name that is not in `OILS`.
    """
    oil, celsius = _OILS[name], temperature - ZERO_CELSIUS
    at_20 = walther_viscosity(ZERO_CELSIUS + 20, oil.viscosity_40, oil.viscosity_100)
    viscosity = walther_viscosity(temperature, oil.viscosity_40, oil.viscosity_100)
    return OilData(
        density=oil.density_15 / (1 + oil.expansion * (celsius - 15)),
        bulk_modulus=oil.bulk_modulus(celsius, at_20),
        vapour_pressure=oil.vapour_pressure(celsius),
        viscosity=1e-6 * viscosity,
    )
