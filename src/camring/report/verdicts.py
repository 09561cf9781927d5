"""What `validation.json` says, as the report's verdict."""

import json
import re
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from camring.files.motor.document import printable
from camring.files.quantities import significant
from camring.presentation.records import Check, Verdict, View
from camring.report.pictures.margins import plain_name

__all__ = ["read_verdict", "validated_trial", "verdict_of"]

_EYES = {
    "search": "as the search saw it",
    "finer": "at finer resolution",
    "independent": "by SciPy's stiff solver",
}


def read_verdict(path: Path, weights: Sequence[float]) -> Verdict | None:
    """The verdict of a validation file; None when there is none.

    Parameters
    ----------
    weights
        Of the operating points.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except OSError:
        return None
    except ValueError:
        text = ""
    try:
        return verdict_of(json.loads(text), weights)
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return Verdict(
            False,
            f"{path.name} cannot be read: `camring resume {shlex.quote(printable(path.parent))}` "
            "validates the best design again.",
        )


def validated_trial(path: Path) -> int | None:
    """Which trial a validation file is about; None when that cannot be read."""
    try:
        trial = json.loads(path.read_text(encoding="utf-8"))["trial"]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None
    return trial if isinstance(trial, int) else None


def verdict_of(document: Mapping[str, Any], weights: Sequence[float] = ()) -> Verdict:
    """Validated only when the document says so in so many words."""
    validated = document.get("validated") is True
    checks = tuple(
        Check(
            _in_words(str(check.get("name", ""))),
            check.get("passed") is True,
            _detail_in_words(str(check.get("detail", ""))),
        )
        for check in document.get("checks", ())
        if isinstance(check, Mapping)
    )
    views = tuple(
        _view(design, _EYES.get(eye, eye), seen, weights)
        for design, eyes in document.get("views", {}).items()
        for eye, seen in eyes.items()
        if isinstance(seen, Mapping) and not seen.get("failure")
    )
    return Verdict(validated, _sentence(document, validated, checks), checks, views)


def _in_words(name: str) -> str:
    """A check's name with results for people, the words in their natural order."""
    name = re.sub(r"^(the \w+ motor's) (.+) results$", r"\1 results \2", name)
    first, space, rest = name.partition(" ")
    return f"{plain_name(first)}{space}{rest}" if "_" in first else name[:1].upper() + name[1:]


def _detail_in_words(detail: str) -> str:
    margin = re.match(r"((?:least )?margin) (-?[\d.]+(?:e-?\d+)?)(?![\w.])", detail)
    if margin:
        rest = _detail_in_words(detail[margin.end() :])
        return f"{margin[1]} {significant(100 * float(margin[2]), 3)} %{rest}"
    return re.sub(r"\b[a-z]+(_[a-z]+)+\b", lambda found: plain_name(found[0]).lower(), detail)


def _sentence(document: Mapping[str, Any], validated: bool, checks: Sequence[Check]) -> str:
    given = document.get("sentence")
    if isinstance(given, str) and given:
        # The head says the word itself.
        text = re.sub(r"^(not )?validated: *", "", given, flags=re.IGNORECASE)
        return text[:1].upper() + text[1:]
    if validated:
        return "Every gain and every limit holds at finer resolution and with another solver."
    failed = [check for check in checks if not check.passed]
    if failed:
        return "; ".join(f"{check.name}: {check.detail}" for check in failed) + "."
    return "The checks were not completed."


def _view(design: str, eye: str, seen: Mapping[str, Any], weights: Sequence[float]) -> View:
    results = seen.get("results", ())

    def mean(name: str) -> float:
        values = [_number(result.get(name)) for result in results]
        if not values or len(values) != len(weights):
            return float("nan")
        return float(np.average(values, weights=weights))

    limits = [_number(value) for value in seen.get("constraints", {}).values()]
    return View(
        design,
        eye,
        _number(seen.get("objective")),
        mean("torque_ripple"),
        mean("efficiency"),
        -max(limits) if limits else float("nan"),
    )


def _number(value: Any) -> float:
    return float(value) if isinstance(value, int | float) else float("nan")
