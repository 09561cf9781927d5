"""What `validation.json` says, as the report's verdict."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from camring.interfaces.report.data import Check, Verdict

__all__ = ["read_verdict", "verdict_of"]


def read_verdict(path: Path) -> Verdict | None:
    """The verdict of a validation file; None when there is none or it cannot be read."""
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return verdict_of(document) if isinstance(document, Mapping) else None


def verdict_of(document: Mapping[str, Any]) -> Verdict:
    """Validated only when the document says so in so many words."""
    validated = document.get("validated") is True
    checks = tuple(
        Check(
            str(check.get("name", "")),
            check.get("passed") is True,
            str(check.get("detail", "")),
        )
        for check in document.get("checks", ())
        if isinstance(check, Mapping)
    )
    return Verdict(validated, _sentence(document, validated, checks), checks)


def _sentence(document: Mapping[str, Any], validated: bool, checks: Sequence[Check]) -> str:
    given = document.get("sentence") or document.get("reason")
    if isinstance(given, str) and given:
        return given
    if validated:
        return "Every gain and every limit holds at finer resolution and with another solver."
    failed = [check for check in checks if not check.passed]
    if failed:
        return "; ".join(f"{check.name}: {check.detail}" for check in failed) + "."
    return "The checks were not completed."
