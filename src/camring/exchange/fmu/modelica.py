"""The same table as a Modelica model, for tools that would rather not import an FMU."""

from camring.exchange.fmu.compiler import source_texts

__all__ = ["modelica_files"]

_TEXT = """\
package {name} "{title}"
  // {said}

  model Motor "Torque and flows from speed and pressures, quasi-steady, with ripple"
    parameter Boolean ripple = true "With the ripple over the shaft angle; else means";
    parameter Modelica.Units.SI.Angle offset = 0 "Of the motor's angle 0 against the flange";
    Modelica.Mechanics.Rotational.Interfaces.Flange_a flange "Shaft" annotation (
      Placement(transformation(extent={{{{90,-10}},{{110,10}}}})));
    Modelica.Blocks.Interfaces.RealInput supplyPressure(unit="Pa", displayUnit="bar") "Absolute"
      annotation (Placement(transformation(extent={{{{-140,40}},{{-100,80}}}})));
    Modelica.Blocks.Interfaces.RealInput returnPressure(unit="Pa", displayUnit="bar") "Absolute"
      annotation (Placement(transformation(extent={{{{-140,-20}},{{-100,20}}}})));
    Modelica.Blocks.Interfaces.RealInput casePressure(unit="Pa", displayUnit="bar") "Absolute"
      annotation (Placement(transformation(extent={{{{-140,-80}},{{-100,-40}}}})));
    Modelica.Blocks.Interfaces.RealOutput supplyFlow(unit="m3/s") "Into the supply port"
      annotation (Placement(transformation(extent={{{{100,60}},{{120,80}}}})));
    Modelica.Blocks.Interfaces.RealOutput returnFlow(unit="m3/s") "Out of the return port"
      annotation (Placement(transformation(extent={{{{100,30}},{{120,50}}}})));
    Modelica.Blocks.Interfaces.RealOutput caseFlow(unit="m3/s") "Out of the case"
      annotation (Placement(transformation(extent={{{{100,-50}},{{120,-30}}}})));
    Modelica.Units.SI.AngularVelocity speed "Of the shaft";
    Modelica.Units.SI.Torque torque "On the shaft, positive in the sense of positive speed";
  protected
    Table table = Table(Modelica.Utilities.Files.loadResource(
      "modelica://{name}/{folder}/table.bin"));
    Real found[4];
  equation
    speed = der(flange.phi);
    found = lookUp(table, speed, supplyPressure, returnPressure, casePressure,
      flange.phi + offset, ripple);
    torque = found[1];
    supplyFlow = found[2];
    returnFlow = found[3];
    caseFlow = found[4];
    flange.tau = -torque;
  end Motor;

  class Table "The motor's table in memory"
    extends ExternalObject;

    function constructor
      input String fileName;
      output Table table;
      external "C" table = camring_modelica_open(fileName) annotation (
        Include="#include \\"camring_modelica.h\\"",
        IncludeDirectory="modelica://{name}/{folder}");
    end constructor;

    function destructor
      input Table table;
      external "C" camring_modelica_close(table) annotation (
        Include="#include \\"camring_modelica.h\\"",
        IncludeDirectory="modelica://{name}/{folder}");
    end destructor;
  end Table;

  pure function lookUp "Torque, supply, return and case flow"
    input Table table;
    input Real speed;
    input Real supplyPressure;
    input Real returnPressure;
    input Real casePressure;
    input Real angle;
    input Boolean ripple;
    output Real result[4];
    external "C" camring_modelica_look_up(table, speed, supplyPressure, returnPressure,
      casePressure, angle, ripple, result) annotation (
        Include="#include \\"camring_modelica.h\\"",
        IncludeDirectory="modelica://{name}/{folder}");
  end lookUp;

  model Example "{speed_rpm:g} rpm and the pressures of the motor file's first operating point"
    Motor motor;
    Modelica.Mechanics.Rotational.Sources.ConstantSpeed shaft(w_fixed={speed!r});
  equation
    motor.supplyPressure = {supply!r};
    motor.returnPressure = {back!r};
    motor.casePressure = {case!r};
    connect(shaft.flange, motor.flange);
    annotation (experiment(StopTime={stop:.6g}, Interval={step:.3g}));
  end Example;

  annotation (uses(Modelica(version="4.0.0")));
end {name};
"""


def modelica_files(
    name: str,
    said: list[str],
    table: bytes,
    start: tuple[float, float, float, float],
    periods: int,
) -> dict[str, bytes]:
    """`NAME.mo` and the folder of table and C code beside it.

    Parameters
    ----------
    said
        What a user should know of the table.
    start
        Speed, supply, return and case pressure of the example in the package.
    periods
        Of the ripple in a revolution.
    """
    speed, supply, back, case = start
    folder, turn = f"{name}_files", 6.283185307179586 / speed
    text = _TEXT.format(
        name=name,
        folder=folder,
        title=_in_quotes(said[0].split(",")[0]),
        said="\n  // ".join(_in_one_line(each) for each in said),
        speed=speed,
        speed_rpm=60 / turn,
        supply=supply,
        back=back,
        case=case,
        stop=2 * turn,
        step=turn / periods / 50,
    )
    sources = source_texts("camring_modelica.h", "camring_table.c", "camring_table.h")
    return {
        f"{name}.mo": text.encode(),
        f"{folder}/table.bin": table,
        **{f"{folder}/{each}": source.encode() for each, source in sources.items()},
    }


def _in_quotes(text: str) -> str:
    return _in_one_line(text).replace("\\", "\\\\").replace('"', '\\"')


def _in_one_line(text: str) -> str:
    return " ".join(text.split())
