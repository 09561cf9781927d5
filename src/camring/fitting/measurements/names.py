"""Names of what a measured table may hold: words, and the symbols of benches and ISO 4409."""

import re
from functools import cache

from camring.files.result_names import si_units
from camring.objective.measurable import CASE_DRAIN, CASE_RISE, MEASURABLE

__all__ = [
    "CASE_TEMPERATURE",
    "CONDITIONS",
    "SYNONYMS",
    "is_aside",
    "is_other_result",
    "meanings",
    "si_unit_of",
    "words",
]

CONDITIONS = {
    "shaft_speed": "rad/s",
    "supply_pressure": "Pa",
    "pressure_drop": "Pa",
    "return_pressure": "Pa",
    "case_pressure": "Pa",
    "oil_temperature": "K",
}
"""What a row says of its operating point, with the unit of the program."""

CASE_TEMPERATURE = "case_temperature"
"""A thermometer's way to say `case_temperature_rise`, beside the oil's temperature."""

SYNONYMS = {
    "speed": "shaft_speed",
    "rotational_speed": "shaft_speed",
    "rotational_frequency": "shaft_speed",
    "inlet_pressure": "supply_pressure",
    "outlet_pressure": "return_pressure",
    "differential_pressure": "pressure_drop",
    "delta_p": "pressure_drop",
    "delta_pressure": "pressure_drop",
    "drain_pressure": "case_pressure",
    "temperature": "oil_temperature",
    "inlet_temperature": "oil_temperature",
    "drain_temperature": CASE_TEMPERATURE,
    "housing_temperature": CASE_TEMPERATURE,
    "case_oil_temperature": CASE_TEMPERATURE,
    "temperature_rise": CASE_RISE,
    "torque": "mean_torque",
    "shaft_torque": "mean_torque",
    "flow": "supply_flow",
    "inlet_flow": "supply_flow",
    "outlet_flow": "return_flow",
    "delivered_flow": "return_flow",
    "delivery_flow": "return_flow",
    "leakage_flow": CASE_DRAIN,
    "leakage": CASE_DRAIN,
    "case_flow": CASE_DRAIN,
    "drain_flow": CASE_DRAIN,
    "case_drain_flow": CASE_DRAIN,
    "total_efficiency": "efficiency",
    "overall_efficiency": "efficiency",
    "mechanical_efficiency": "hydromechanical_efficiency",
}

_SYMBOLS: dict[str, str] = {
    "n": "shaft_speed",
    "n_1 n1 n_e ne": "shaft_speed",
    "p1 p_1 p1e pe p_e pin p_in pin p_A pA ps p_s p_supply": "supply_pressure",
    "p2 p_2 p2e pa p_a pout p_out p_B pB p_r pr p_return": "return_pressure",
    "p3 p_3 p_L pL pc p_c p_d pd p_case": "case_pressure",
    "dp d_p Δp ∆p Dp DP delta_p deltap δp": "pressure_drop",
    "M Md M_d Mt T M_e Me T_e Te T_2 T2 M_2 M2": "mean_torque",
    "Q Q1 Q_1 q q1 qv q_v qV q_V qVe q_Ve qV1 q_V1 qV1e q_V1e Qe Q_e V̇": "supply_flow",
    "Q2 Q_2 q2 q_2 qV2 q_V2 qV2e q_V2e": "return_flow",
    "Qd Q_d qd q_d qVd q_Vd QL Q_L qL q_L Q_leak Q3 Q_3 q_V3 Q_case": CASE_DRAIN,
    "eta η eta_t ηt η_t eta_ges ηges η_ges eta_tot ηtot": "efficiency",
    "eta_v ηv η_v eta_V ηV η_V eta_vol ηvol η_vol": "volumetric_efficiency",
    "eta_hm ηhm η_hm eta_mh ηmh η_mh eta_m ηm η_m": "hydromechanical_efficiency",
    "Ph P_h Phyd P_hyd Pin P_in P1 P_1": "input_power",
    "Pm P_m Pmech P_mech Pout P_out P2 P_2": "output_power",
    "theta θ ϑ t_oil T_oil t T t_1 θ_1 theta_1": "oil_temperature",
}


@cache
def _by_symbol() -> dict[str, tuple[str, ...]]:
    found: dict[str, tuple[str, ...]] = {}
    for symbols, name in _SYMBOLS.items():
        for symbol in dict.fromkeys(_bare(each) for each in symbols.split()):
            found[symbol] = (*found.get(symbol, ()), name)
    return found


def meanings(written: str) -> tuple[str, ...]:
    """What a name may mean, the likeliest first; nothing where it is not known.

    A symbol such as `T` may be a torque or a temperature; its unit decides.
    """
    written = _OF_A_POINT.sub("", written.strip())
    name = re.sub(r"[\s_-]+", "_", written.lower()).strip("_")
    name = SYNONYMS.get(name, name)
    if name in CONDITIONS or name in MEASURABLE or name == CASE_TEMPERATURE:
        return (name,)
    return _by_symbol().get(_bare(written), ())


def is_other_result(written: str) -> bool:
    """Whether camring writes it into its own tables, but no bench measures it."""
    name = re.sub(r"[\s_-]+", "_", written.strip().lower())
    return name in si_units() or name in _OWN or name.startswith(("margin_", "share_"))


_ASIDE = frozenset(
    [
        "no",
        "nr",
        "id",
        "row",
        "test",
        "time",
        "date",
        "clock",
        "remark",
        "remarks",
        "comment",
        "note",
        "notes",
        "operator",
        "zeit",
        "datum",
        "uhrzeit",
        "bemerkung",
    ]
)
_OF_A_POINT = re.compile(r"operating_points(\[\d+\])?\.")
_OWN = {"operating_point", "weight", "sound", "status", "fault", "verdict", "within_limits"}


def is_aside(written: str) -> bool:
    """Whether it is what benches write beside their numbers: `No.`, `Time`, `Remark`."""
    return written.strip().strip(".").lower() in _ASIDE


def si_unit_of(name: str) -> str:
    """The unit in which the program keeps a condition or a result."""
    return "K" if name == CASE_TEMPERATURE else CONDITIONS.get(name) or si_units()[name]


def words(name: str) -> str:
    return name.replace("_", " ")


def _bare(symbol: str) -> str:
    """Without the signs of an index; case counts, as `p` is a pressure and `P` a power."""
    return re.sub(r"[\s_,;.{}-]+", "", symbol)
