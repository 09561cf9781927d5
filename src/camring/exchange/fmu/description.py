"""modelDescription.xml: what an importer reads of an FMU before it loads it."""

from dataclasses import dataclass
from math import pi
from xml.sax.saxutils import quoteattr

from camring.exchange.fmu.compiler import SOURCES
from camring.physics.operating_point import OperatingPoint
from camring.version import __version__

__all__ = ["VARIABLES", "Variable", "model_description", "starts"]


@dataclass(frozen=True)
class Variable:
    """One variable of the FMU; its place in `VARIABLES` is its value reference."""

    name: str
    description: str
    causality: str
    unit: str
    display: str = ""


VARIABLES = (
    Variable("speed", "shaft speed", "input", "rad/s", "rpm"),
    Variable("supplyPressure", "pressure at the supply port, absolute", "input", "Pa", "bar"),
    Variable("returnPressure", "pressure at the return port, absolute", "input", "Pa", "bar"),
    Variable("casePressure", "pressure in the case, absolute", "input", "Pa", "bar"),
    Variable("torque", "torque on the shaft, positive in the sense of positive speed", "output",
             "N.m"),
    Variable("supplyFlow", "flow into the motor by the supply port", "output", "m3/s", "L/min"),
    Variable("returnFlow", "flow out of the motor by the return port", "output", "m3/s", "L/min"),
    Variable("caseFlow", "flow out of the motor past the pistons", "output", "m3/s", "L/min"),
    Variable("angle", "shaft angle, the integral of the speed", "output", "rad", "deg"),
    Variable("initialAngle", "shaft angle at the start", "parameter", "rad", "deg"),
)  # fmt: skip
RIPPLE = "with the ripple over the shaft angle; without it means over a revolution"

# Unit -> its exponents as FMI writes them; display unit -> its number for one SI unit.
_UNITS = {
    "rad/s": ('s="-1" rad="1"', {"rpm": 60 / (2 * pi)}),
    "Pa": ('kg="1" m="-1" s="-2"', {"bar": 1e-5}),
    "N.m": ('kg="1" m="2" s="-2"', {}),
    "m3/s": ('m="3" s="-1"', {"L/min": 6e4}),
    "rad": ('rad="1"', {"deg": 180 / pi}),
}
_STEPS_OF_A_PERIOD = 50
_REVOLUTIONS = 2


def starts(point: OperatingPoint) -> tuple[float, float, float, float]:
    """Of the four inputs: an operating point of the motor file."""
    pressures = (point.supply_pressure, point.return_pressure, point.case_pressure)
    supply, back, case = (float(each) for each in pressures)
    return float(point.shaft_speed), supply, back, case


def model_description(
    name: str, guid: str, description: str, moment: str, point: OperatingPoint, periods: int
) -> str:
    """The file's text.

    Parameters
    ----------
    name
        Of model and library.
    moment
        When it was made, as `2025-01-31T12:00:00Z`.
    point
        What the inputs start with.
    periods
        Of the ripple in a revolution: the proposed step resolves it.
    """
    turn = 2 * pi / float(point.shaft_speed)
    head = {
        "fmiVersion": "2.0",
        "modelName": name,
        "guid": guid,
        "description": description,
        "version": __version__,
        "generationTool": f"camring {__version__}",
        "generationDateAndTime": moment,
        "variableNamingConvention": "flat",
    }
    abilities = {
        "modelIdentifier": name,
        "canHandleVariableCommunicationStepSize": "true",
        "canNotUseMemoryManagementFunctions": "true",
        "canGetAndSetFMUstate": "true",
        "canSerializeFMUstate": "true",
    }
    experiment = {
        "startTime": "0",
        "stopTime": f"{_REVOLUTIONS * turn:.6g}",
        "stepSize": f"{turn / periods / _STEPS_OF_A_PERIOD:.3g}",
    }
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f"<fmiModelDescription{_attributes(head)}>",
        f"  <CoSimulation{_attributes(abilities)}>",
        "    <SourceFiles>",
        *(f"      <File{_attributes({'name': each})}/>" for each in SOURCES),
        "    </SourceFiles>",
        "  </CoSimulation>",
        "  <UnitDefinitions>",
        *_units(),
        "  </UnitDefinitions>",
        "  <LogCategories>",
        '    <Category name="logStatusWarning" description="inputs outside the table, once each"/>',
        '    <Category name="logStatusError" description="calls that are not allowed"/>',
        "  </LogCategories>",
        f"  <DefaultExperiment{_attributes(experiment)}/>",
        "  <ModelVariables>",
        *_variables(starts(point)),
        "  </ModelVariables>",
        "  <ModelStructure>",
        *_structure(),
        "  </ModelStructure>",
        "</fmiModelDescription>",
    ]
    return "\n".join(lines) + "\n"


def _attributes(values: dict[str, str]) -> str:
    return "".join(f" {name}={quoteattr(value)}" for name, value in values.items())


def _units() -> list[str]:
    lines = []
    for unit, (exponents, displays) in _UNITS.items():
        lines.append(f'    <Unit name="{unit}">')
        lines.append(f"      <BaseUnit {exponents}/>")
        for display, factor in displays.items():
            lines.append(f'      <DisplayUnit name="{display}" factor="{factor!r}"/>')
        lines.append("    </Unit>")
    return lines


def _variables(start: tuple[float, ...]) -> list[str]:
    lines = []
    for number, each in enumerate(VARIABLES):
        attributes = {
            "name": each.name,
            "valueReference": str(number),
            "description": each.description,
            "causality": each.causality,
        }
        kind = {"unit": each.unit}
        if each.display:
            kind["displayUnit"] = each.display
        if each.causality == "output":
            attributes |= {"variability": "continuous", "initial": "calculated"}
        elif each.causality == "input":
            attributes["variability"] = "continuous"
            kind["start"] = repr(start[number])
        else:
            attributes |= {"variability": "fixed", "initial": "exact"}
            kind["start"] = "0"
        lines.append(f"    <ScalarVariable{_attributes(attributes)}>")
        lines.append(f"      <Real{_attributes(kind)}/>")
        lines.append("    </ScalarVariable>")
    attributes = {"name": "ripple", "valueReference": str(len(VARIABLES)), "description": RIPPLE,
            "causality": "parameter", "variability": "tunable", "initial": "exact"}  # fmt: skip
    lines.append(f"    <ScalarVariable{_attributes(attributes)}>")
    return [*lines, '      <Boolean start="true"/>', "    </ScalarVariable>"]


def _structure() -> list[str]:
    inputs = " ".join(str(i) for i, each in enumerate(VARIABLES, 1) if each.causality == "input")
    outputs = [(i, each) for i, each in enumerate(VARIABLES, 1) if each.causality == "output"]
    known = {each.name: "" if each.name == "angle" else inputs for _, each in outputs}
    return [
        "    <Outputs>",
        *(f'      <Unknown index="{i}" dependencies="{known[each.name]}"/>' for i, each in outputs),
        "    </Outputs>",
        "    <InitialUnknowns>",
        *(f'      <Unknown index="{i}"/>' for i, _ in outputs),
        "    </InitialUnknowns>",
    ]
