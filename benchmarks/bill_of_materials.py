"""What camring consists of where it is installed: a software bill of materials.

    python benchmarks/bill_of_materials.py [EXTRA ...] > bill.json

CycloneDX 1.6 in JSON, of the packages of this environment that camring needs, with the extras
named: name, version, licence as the package states it, what each needs, and the SHA-256
of its list of installed files (RECORD), which holds a digest of every one. Nothing is fetched.
"""

import hashlib
import json
import re
import sys
import uuid
from collections.abc import Sequence
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from typing import Any

from packaging.requirements import Requirement

ROOT = "camring"
FIRST_LINE = 120  # signs; some packages state the whole text of their licence


def bill(extras: Sequence[str] = ()) -> dict[str, Any]:
    """The document; the same environment gives the same one.

    Raises
    ------
    PackageNotFoundError
        Where camring itself is not installed.
    """
    found: dict[str, Distribution] = {}
    needs: dict[str, list[str]] = {}
    waiting = [(ROOT, tuple(extras))]
    while waiting:
        name, wanted = waiting.pop()
        try:
            package = found.setdefault(name, distribution(name))
        except PackageNotFoundError:
            if name == ROOT:
                raise
            continue  # of an extra that is not installed
        for each in _requirements(package, wanted):
            other = _plain(each.name)
            if other not in needs.setdefault(name, []):
                needs[name].append(other)
                waiting.append((other, tuple(each.extras)))
        needs.setdefault(name, [])
    parts = [_component(name, found[name]) for name in sorted(found) if name != ROOT]
    content = json.dumps(parts, sort_keys=True)
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "serialNumber": f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_OID, content)}",
        "version": 1,
        "metadata": {"component": {**_component(ROOT, found[ROOT]), "type": "application"}},
        "components": parts,
        "dependencies": [
            {"ref": name, "dependsOn": sorted(each for each in needs[name] if each in found)}
            for name in sorted(found)
        ],
    }


def _requirements(package: Distribution, extras: Sequence[str]) -> list[Requirement]:
    """What applies here, with these extras."""
    found = []
    for text in package.requires or ():
        each = Requirement(text)
        settings = [{"extra": extra} for extra in ("", *extras)]
        if each.marker is None or any(map(each.marker.evaluate, settings)):
            found.append(each)
    return found


def _component(name: str, package: Distribution) -> dict[str, Any]:
    found: dict[str, Any] = {
        "type": "library",
        "bom-ref": name,
        "name": name,
        "version": package.version,
        "purl": f"pkg:pypi/{name}@{package.version}",
    }
    licence = _licence(package)
    if licence:
        found["licenses"] = [{"license": {"name": licence}}]
    record = package.read_text("RECORD")
    if record:
        digest = hashlib.sha256(record.encode()).hexdigest()
        found["properties"] = [{"name": "sha256 of RECORD", "value": digest}]
    return found


def _licence(package: Distribution) -> str:
    about = package.metadata
    stated = about.get("License-Expression") or about.get("License") or ""
    classed = [
        each.rpartition(" :: ")[2]
        for each in about.get_all("Classifier", [])
        if each.startswith("License :: ")
    ]
    text = stated.strip().splitlines()[0] if stated.strip() else " and ".join(classed)
    return text[:FIRST_LINE]


def _plain(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


if __name__ == "__main__":
    json.dump(bill(sys.argv[1:]), sys.stdout, indent=1)
    print()
