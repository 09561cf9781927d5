"""A user's FMU as the evaluator of designs.

`python -m camring.evaluation.user_programs.fmu machine.toml`: a program of the kind that
`command` runs, so that an FMU which crashes, hangs or answers NaN is one failed evaluation: it is
native code, in a process that is not ours.
"""

import json
import math
import os
import sys
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from camring.files.archive import require_harmless
from camring.files.errors import CamringError, InputError, quote
from camring.files.units import UnitError, to_si

KEYS = ("fmu", "until", "step", "parameters", "results")
OF_A_RESULT = ("output", "take", "last", "relative", "factor")
HERE = "operating_point."
TAKES = ("final", "mean", "min", "max", "peak to peak", "rms", "one-sided rms")
Wave = Float[np.ndarray, " sample"]


@dataclass(frozen=True)
class Mapped:
    """Which FMU, for how long, and how its variables are called in camring.

    Attributes
    ----------
    until, step
        Of the simulation, as the file says: a time, or an angle of the shaft.
    parameters
        Variable of the FMU to a number, or to the key of a design or operating point.
    results
        Result of ours to how it is taken from an output.
    """

    fmu: Path
    until: str
    step: str
    parameters: Mapping[str, Any]
    results: Mapping[str, Mapping[str, Any]]

    @classmethod
    def read(cls, path: Path) -> "Mapped":
        """From a TOML file.

        Raises
        ------
        InputError
            When it cannot be read, a key is missing or unknown, or there is no such FMU.
        """
        try:
            table = tomllib.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise InputError(str(path), f"cannot be read ({error})", "give a TOML file") from None
        _require_known(str(path), table, KEYS)
        for key in KEYS:
            if key not in table:
                raise InputError(key, f"is missing in {path}", f"give {', '.join(KEYS)}")
        for key in ("parameters", "results"):
            if not isinstance(table[key], dict):
                raise InputError(key, f"is {quote(table[key])} in {path}", f"write it as [{key}]")
        for name, taken in table["results"].items():
            where = f"results.{name}"
            if not isinstance(taken, dict) or "output" not in taken:
                raise InputError(where, "names no output", 'give { output = "torque" }')
            _require_known(where, taken, OF_A_RESULT)
            if taken.get("take", "mean") not in TAKES:
                raise InputError(
                    f"{where}.take", f"is {quote(taken['take'])}", f"choose {', '.join(TAKES)}"
                )
        fmu = path.parent / str(table["fmu"])
        if not fmu.is_file():
            raise InputError("fmu", f"is {quote(str(fmu))}, which is no file", "correct the path")
        return cls(fmu, *(table[key] for key in KEYS[1:]))

    def outputs(self) -> list[str]:
        """Every variable that is read, once."""
        return list(dict.fromkeys(str(taken["output"]) for taken in self.results.values()))


def seconds(where: str, text: Any, shaft_speed: float) -> float:
    """A span of time, also given as an angle of the shaft: "20 ms", "2 turn", "0.5 deg".

    Raises
    ------
    InputError
        When it is neither, not above zero, or an angle of a shaft that stands still.
    """
    try:
        found = to_si(str(text), "s")
    except UnitError:
        try:
            angle = to_si(str(text), "rad")
        except UnitError as error:
            raise InputError(where, f"is {error}", 'give such as "2 s" or "3 turn"') from None
        found = angle / abs(shaft_speed) if shaft_speed else math.inf
    if not 0 < found < math.inf:
        raise InputError(where, f"is {quote(text)}, {found:g} s", "give a span above zero")
    return found


def taken_from(time: Wave, wave: Wave, span: float, step: float, how: Mapping[str, Any]) -> float:
    """A result from an output's course, over its last `span` seconds.

    Equidistant samples, the number of steps in the span: exact for a periodic course whose
    period the span holds whole and the step divides.
    """
    count = max(1, round(span / step))
    end = float(time[-1])
    last = np.interp(end - span * np.arange(count - 1, -1, -1) / count, time, wave)
    mean = float(np.mean(last))
    rms = float(np.sqrt(np.mean((last - mean) ** 2)))
    found = {
        "final": float(wave[-1]),
        "mean": mean,
        "min": float(np.min(last)),
        "max": float(np.max(last)),
        "peak to peak": float(np.ptp(last)),
        "rms": rms,
        "one-sided rms": rms / math.sqrt(2.0),
    }[how.get("take", "mean")]
    if how.get("relative", False):
        found = found / abs(mean) if mean else math.nan
    return found * float(how.get("factor", 1.0))


def start_values(
    mapped: Mapped, design: Mapping[str, Any], point: Mapping[str, float]
) -> dict[str, Any]:
    """What the FMU's variables are set to for a design at an operating point."""
    known: dict[str, Any] = {f"{HERE}{name}": value for name, value in point.items()}
    for key, value in design.items():
        known[key] = value
        if isinstance(value, list):
            known |= {f"{key}[{place}]": each for place, each in enumerate(value)}
    found = {}
    for name, given in mapped.parameters.items():
        if isinstance(given, str):
            if isinstance(known.get(given, []), list):
                raise InputError(
                    f"parameters.{name}",
                    f"is {quote(given)}, which is no number of this design{_near(given, known)}",
                    f"choose among {', '.join(k for k in known if not isinstance(known[k], list))}",
                )
            given = known[given]
        found[name] = given
    return found


def evaluated(mapped: Mapped, document: Mapping[str, Any]) -> list[dict[str, float]]:
    """Results at each operating point of the design that a document asks about.

    Raises
    ------
    InputError
        When the file names what the FMU or the design has not.
    """
    try:
        import fmpy
    except ImportError:
        raise InputError(
            "fmu", "needs the extra fmu, which is missing", 'pip install "camring[fmu]"'
        ) from None
    require_harmless(mapped.fmu)
    described = fmpy.read_model_description(str(mapped.fmu), validate=False)
    variables = [variable.name for variable in described.modelVariables]
    for name in (*mapped.parameters, *mapped.outputs()):
        if name not in variables:
            raise InputError(
                quote(name),
                f"is no variable of {mapped.fmu.name}{_near(name, variables)}",
                "correct the name",
            )
    # Unpacked beside the motor file, whose folder is cleared also when this process is killed.
    folder = str(Path(document["motor_file"]).parent / "fmu")
    fmpy.extract(str(mapped.fmu), unzipdir=folder)
    found = []
    for point in document["points"]:
        speed = point["shaft_speed"]
        until, step = (seconds(key, getattr(mapped, key), speed) for key in ("until", "step"))
        course = fmpy.simulate_fmu(
            folder,
            validate=False,
            stop_time=until,
            step_size=step,
            output_interval=step,
            start_values=start_values(mapped, document["design"], point),
            output=mapped.outputs(),
            model_description=described,
        )
        results = {}
        for name, how in mapped.results.items():
            where = f"results.{name}.last"
            span = seconds(where, how["last"], speed) if "last" in how else until
            if span > until * (1 + 1e-9):
                raise InputError(
                    where, f"is {span:g} s, more than until, {until:g} s", "shorten it"
                )
            results[name] = taken_from(course["time"], course[how["output"]], span, step, how)
        found.append(results)
    return found


def _require_known(where: str, table: Mapping[str, Any], keys: Sequence[str]) -> None:
    for key in table:
        if key not in keys:
            raise InputError(
                f"{where}: {quote(key)}", f"is no key{_near(key, keys)}", f"use {', '.join(keys)}"
            )


def _near(name: str, names: Any) -> str:
    close = get_close_matches(name, list(names), n=1)
    return f" (did you mean {quote(close[0])}?)" if close else ""


def command_for(path: str | Path) -> list[str]:
    """The words of the program that evaluates by the FMU of a file.

    Raises
    ------
    InputError
        As `Mapped.read`.
    """
    Mapped.read(Path(path))
    return [sys.executable, "-m", __name__, str(Path(path).resolve())]


def main(arguments: Sequence[str]) -> int:
    """Reads a question on stdin and answers on stdout; 1 and a sentence when it cannot."""
    # What the FMU prints must not stand in the answer.
    answer = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    try:
        if len(arguments) != 1:
            raise InputError(
                "the evaluator of an FMU", "takes one file", "name it, such as machine.toml"
            )
        found = evaluated(Mapped.read(Path(arguments[0])), json.load(sys.stdin))
    except CamringError as error:
        print(error, file=sys.stderr)
        return 1
    except Exception as error:  # FMPy's own, of an FMU that refuses a value or a step
        print(f"{type(error).__name__}: {error}".splitlines()[0], file=sys.stderr)
        return 1
    with answer:
        json.dump({"results": found}, answer)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
