"""Where a report comes from: input, versions, machine kind, date."""

import platform
from collections.abc import Mapping
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version

from camring.presentation.records import Provenance
from camring.version import __version__

__all__ = ["provenance_of", "versions"]

_PACKAGES = ("jax", "jaxlib", "equinox", "numpy", "scipy")


def versions() -> dict[str, str]:
    """What computed the numbers."""
    found = {"camring": __version__, "Python": platform.python_version()}
    for package in _PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            continue
    found["System"] = f"{platform.system()} on {platform.machine()}"
    return found


def provenance_of(
    input_name: str, input_text: str, best_text: str = "", settings: Mapping[str, str] | None = None
) -> Provenance:
    """The record of a report made now."""
    now = datetime.now(UTC)
    return Provenance(
        input_name,
        input_text,
        best_text,
        versions(),
        dict(settings or {}),
        f"{now.day} {now:%B %Y, %H:%M} UTC",
    )
