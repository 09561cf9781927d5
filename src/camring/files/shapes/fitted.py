"""`[motor.cam] profile = "FILE"`: a ring that others drew or measured becomes control radii.

The motor file's text is changed as it is read: the fitted radii stand in place of the
profile's keys, with a remark. Whatever is kept of it, a study's folder or a worker's copy,
needs the profile no more.
"""

import re
import tomllib
from dataclasses import dataclass
from math import degrees, pi
from os import fspath
from pathlib import Path
from typing import Any

import numpy as np

from camring.files.errors import InputError
from camring.files.motor.document import printable
from camring.files.motor.tables import MotorTable, RadialCamTable
from camring.files.motor.writer import literal, whole_text
from camring.files.shapes.cam_table import read_cam_table
from camring.files.shapes.curve_file import read_curve_file
from camring.files.shapes.drawing import read_drawing
from camring.files.shapes.given_curve import SURFACE, GivenCurve, covered
from camring.geometry.profile_fit import RadiiFit, fit_radii, fit_radii_to_noise

__all__ = [
    "PROFILE_KEYS",
    "FittedCam",
    "fitted_cam",
    "names_profile",
    "read_curve",
    "require_profile_for_its_keys",
    "with_placeholder",
    "with_radii",
]

PROFILE_KEYS = (
    "profile",
    "tolerance",
    "profile_curve",
    "profile_turn",
    "base_radius",
    "control_count",
)
_READERS = {".dxf": read_drawing, ".sldcrv": read_curve_file}
_COUNTS = (8, 10, 12, 14, 16, 18, 20, 24, 28, 30, 32, 36, 40, 48, 56, 60, 64, 72, 80, 96, 120)
MOST_RADII = 720
_FEWEST_A_RADIUS = 2.0  # points for each control radius
_OFF_CENTRE = 0.01  # of a pitch, by which a dead centre may lie beside angle 0 unsaid


@dataclass(frozen=True, eq=False)
class FittedCam:
    """A profile and the control radii that were fitted to it.

    Attributes
    ----------
    path
        The profile's file.
    fit
        Control radii and distances, m.
    around_ring
        Whether the points go round the ring, not over one lobe.
    turn
        By which the points were turned, rad.
    tolerance
        That the largest distance keeps, m.
    notes
        What was taken for granted, a sentence each.
    """

    path: Path
    fit: RadiiFit
    around_ring: bool
    turn: float
    tolerance: float
    notes: tuple[str, ...]

    @property
    def sentence(self) -> str:
        """What was fitted to what, and how near it is."""
        fit = self.fit
        period = "the ring" if fit.repeats == 1 else "a lobe"
        each = len(fit.residuals) / len(fit.control_radii)
        folded = ", all lobes laid on one" if self.around_ring and fit.repeats > 1 else ""
        curve = "working surface" if fit.distance else "pitch curve"
        return (
            f"Cam fitted to {printable(self.path)}: {len(fit.residuals)} points of the {curve}"
            f"{folded}, {len(fit.control_radii)} control radii of {period}, each smoothing over "
            f"{each:.3g} points; the points lie {1e6 * fit.rms:.3g} um rms and at most "
            f"{1e6 * fit.largest:.3g} um from it (tolerance {1e6 * self.tolerance:.3g} um)."
        )

    def document(self) -> dict[str, Any]:
        """The same for programs, SI."""
        return {
            "file": printable(self.path),
            "points": len(self.fit.residuals),
            "curve": "surface" if self.fit.distance else "pitch",
            "control_radii": len(self.fit.control_radii),
            "around_ring": self.around_ring,
            "rms_residual": self.fit.rms,
            "largest_residual": self.fit.largest,
            "tolerance": self.tolerance,
            "notes": list(self.notes),
        }


def read_curve(path: str | Path, on: str | None, base_radius: float | None = None) -> GivenCurve:
    """The points of a table, a drawing or a curve file, by the file's ending.

    Raises
    ------
    InputError
        In one sentence with file and line.
    """
    place = Path(fspath(path))
    reader = _READERS.get(place.suffix.lower())
    if reader is not None:
        return reader(place, on)
    return read_cam_table(place, on, base_radius)


def fitted_cam(motor: MotorTable, folder: Path) -> FittedCam:
    """The control radii of a motor whose cam names a profile.

    Parameters
    ----------
    folder
        Of the motor file, from which a relative path counts.

    Raises
    ------
    InputError
        For a profile that cannot be read, covers no lobe, or lies further from every spline
        than the tolerance.
    """
    cam = motor.cam
    assert isinstance(cam, RadialCamTable)
    assert cam.profile is not None
    path, pitch = Path(cam.profile), 2 * pi / motor.lobes
    curve = read_curve(folder / path, cam.profile_curve, cam.base_radius)
    curve, period = covered(curve, pitch, cam.tolerance)
    around = period > 1.5 * pitch or motor.lobes == 1
    if cam.symmetry == "ring" and not around:
        raise InputError(
            "motor.cam.symmetry",
            f'is "ring", but {curve.shown} holds one lobe',
            "leave symmetry out, or give the points of the whole ring",
        )
    distance = motor.roller.radius if curve.on == SURFACE else 0.0
    fit = _fit(curve.turned(cam.profile_turn), motor, cam, distance)
    _require_within(fit, curve, cam.tolerance)
    notes = curve.notes + _beside_zero(fit, motor.lobes)
    return FittedCam(path, fit, around, cam.profile_turn, cam.tolerance, notes)


def _fit(curve: GivenCurve, motor: MotorTable, cam: RadialCamTable, distance: float) -> RadiiFit:
    repeats = motor.lobes if cam.symmetry == "lobes" else 1
    lobes = motor.lobes // repeats
    if distance and float(np.min(curve.radii)) <= distance:
        raise InputError(
            curve.shown,
            f"has a working surface of {1e3 * float(np.min(curve.radii)):.4g} mm radius, within "
            f"the roller's {1e3 * distance:.4g} mm",
            "check its unit, and motor.roller.radius",
        )
    most = min(MOST_RADII, int(len(curve.radii) / _FEWEST_A_RADIUS))
    if cam.control_count is not None:
        counts = [cam.control_count]
        if cam.control_count > most:
            raise InputError(
                "motor.cam.control_count",
                f"is {cam.control_count}, too many for the {len(curve.radii)} points of "
                f"{curve.shown}",
                f"give at most {most}, or more points",
            )
    else:
        counts = [lobes * count for count in _COUNTS if cam.degree < lobes * count <= most]
        if not counts:
            raise InputError(
                curve.shown, f"has only {len(curve.radii)} points", "give a point every degree"
            )
    try:
        if len(counts) == 1:
            return fit_radii(curve.points, counts[0], repeats, cam.degree, distance)
        return fit_radii_to_noise(curve.points, counts, repeats, cam.degree, distance)
    except np.linalg.LinAlgError:
        raise InputError(
            curve.shown,
            "leaves stretches without points",
            "give points at equal angles, or a smaller motor.cam.control_count",
        ) from None


def _require_within(fit: RadiiFit, curve: GivenCurve, tolerance: float) -> None:
    if not fit.largest > tolerance:
        return
    worst = int(np.argmax(np.abs(fit.residuals)))
    place = f"{curve.shown} {curve.places[worst]}".strip()
    raise InputError(
        place,
        f"lies {1e6 * fit.largest:.4g} um from the fitted cam at {degrees(fit.angles[worst]):.4g} "
        f"deg ({len(fit.control_radii)} control radii, {1e6 * fit.rms:.3g} um rms), more than "
        f"motor.cam.tolerance of {1e6 * tolerance:.4g} um",
        "remove an outlier or another curve there; else give more motor.cam.control_count, "
        'write symmetry = "ring" where lobes differ, or raise the tolerance',
    )


def _beside_zero(fit: RadiiFit, lobes: int) -> tuple[str, ...]:
    """Where the smallest radius is not at angle 0, the windows' defaults do not suit."""
    pitch = 2 * pi / lobes
    inner = fit.outline.extreme_radius(-1)[1]
    beside = (inner + pitch / 2) % pitch - pitch / 2
    if abs(beside) <= _OFF_CENTRE * pitch:
        return ()
    return (
        f"Its inner dead centre lies {degrees(beside):.4g} deg from angle 0, from which the "
        f'windows\' usual centres count; profile_turn = "{degrees(-beside):.6g} deg" turns it '
        "there.",
    )


def with_radii(text: str, document: dict[str, Any], found: FittedCam) -> str:
    """The motor file's text with the fitted radii in place of the profile's keys."""
    radii = [f"{1e3 * each:.8f} mm" for each in found.fit.control_radii]
    cam = {k: v for k, v in document["motor"]["cam"].items() if k not in PROFILE_KEYS}
    motor = {**document["motor"], "cam": {**cam, "control_radii": radii}}
    wanted = {**document, "motor": motor}
    remark = re.sub(r"[^ -~]", "?", found.sentence)
    changed = _in_layout(text, f"# {remark}\ncontrol_radii = {literal(radii)}")
    try:
        if tomllib.loads(changed) == wanted:
            return changed
    except tomllib.TOMLDecodeError:
        pass
    return f"# {remark}\n{whole_text(wanted)}"


def _in_layout(text: str, line: str) -> str:
    """The text without the profile's lines, and with another in place of the first."""
    found, inside, written = [], False, False
    key = re.compile(rf"\s*({'|'.join(PROFILE_KEYS)})\s*=")
    for row in text.split("\n"):
        if row.lstrip().startswith("["):
            inside = re.match(r"\s*\[\s*motor\s*\.\s*cam\s*\]", row) is not None
        if inside and key.match(row):
            if not written:
                found.append(line)
            written = True
        else:
            found.append(row)
    return "\n".join(found)


def with_placeholder(document: dict[str, Any]) -> dict[str, Any]:
    """The document with some control radii where it names a profile, so that keys are checked.

    Raises
    ------
    InputError
        For a profile beside control radii.
    """
    cam = _cam(document)
    if "profile" not in cam:
        return document
    if "control_radii" in cam:
        raise InputError(
            "motor.cam.profile",
            "has no effect beside control_radii",
            "leave one of the two out",
        )
    if cam.get("representation", "radial") != "radial":
        return document
    some = {**cam, "control_radii": [1.0] * 8}
    return {**document, "motor": {**document["motor"], "cam": some}}


def require_profile_for_its_keys(document: dict[str, Any]) -> None:
    """Refuse keys of a profile where there is none.

    Raises
    ------
    InputError
        For the first such key.
    """
    cam = _cam(document)
    for key in PROFILE_KEYS:
        if key in cam and "profile" not in cam:
            raise InputError(
                f"motor.cam.{key}",
                "has no effect without motor.cam.profile",
                "leave it out, or name the profile's file",
            )


def names_profile(document: dict[str, Any]) -> bool:
    """Whether a document's cam names a profile."""
    return "profile" in _cam(document)


def _cam(document: dict[str, Any]) -> dict[str, Any]:
    motor = document.get("motor")
    cam = motor.get("cam") if isinstance(motor, dict) else None
    return cam if isinstance(cam, dict) else {}
