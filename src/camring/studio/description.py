"""The open motor in words for the page: every field, limit, operating point and snapshot."""

import math
from pathlib import Path
from typing import Any

import numpy as np

from camring.analyses.oil_use import unread_viscosity
from camring.drawing.palette import LOSSES, PRESSURE_STOPS
from camring.evaluation.crowding import crowded
from camring.files.point_names import name_of
from camring.files.quantities import QUANTITIES
from camring.metrics.shown import METRICS, ORDERS
from camring.physics.envelope import EnvelopeGrid
from camring.physics.operating_point import OperatingPoint
from camring.physics.rotation import in_mode
from camring.presentation.limits import limits_set
from camring.report.pictures.margins import plain_name
from camring.studies.database import DATABASE_NAME
from camring.studio.arrows import STEP_WORDS, WANTED
from camring.studio.envelope_map import SHOWN, Range
from camring.studio.evaluation import shown_repeats
from camring.studio.session import Session

MODE_SHARE = 0.2  # of the stroke: half the length of a mode's slider, for harmonic 1
MOST_FILES = 200


def described(session: Session) -> dict[str, Any]:
    """Everything but the numbers that move."""
    opened, memory = session.opened, session.memory
    file = opened.file
    motor = file.system.motor
    return {
        "type": "model",
        "title": motor.name or session.path.stem.replace("_", " "),
        "file": str(session.path.relative_to(session.folder.resolve()))
        if session.path.is_relative_to(session.folder.resolve())
        else session.path.name,
        "on_disk": memory.saved is not None,
        "unsaved": memory.unsaved,
        "undo": memory.labels[memory.at] if memory.at else None,
        "redo": memory.labels[memory.at + 1] if memory.at + 1 < len(memory.texts) else None,
        "snapshots": list(memory.snapshots),
        "pinned": memory.pinned,
        "typed": memory.typed,
        "note": session.note,
        "warnings": [*crowded(motor, float(np.min(opened.hand.given))), *unread_viscosity(file)],
        "point": session.point,
        "points": _points(session),
        "fields": [each.as_message() for each in opened.fields],
        "cam": _cam(session),
        "motor": {
            "pistons": motor.pistons,
            "lobes": motor.lobes,
            "repeats": shown_repeats(file.system),
            "order": motor.surviving_order,
            "orders": min(ORDERS, max(file.goal.harmonics, 12) // motor.surviving_order),
            "roller": float(motor.roller.radius),
            "bore": float(motor.piston.bore),
            "outer": file.outer_diameter,
        },
        "limits": _limits(session),
        "metrics": METRICS,
        "envelope": _envelope(opened.where),
        "mapped": SHOWN,
        "sloped": WANTED,
        "step": STEP_WORDS,
        "searchable": file.design_space is not None,
        "budget": file.search.budget,
        "evaluator": file.evaluator is not None,
        "quantities": {
            name: {
                "label": each.label,
                "unit": each.unit,
                "factor": each.factor,
                "digits": each.digits,
                "better": each.better,
            }
            for name, each in QUANTITIES.items()
        },
        "losses": LOSSES,
        "pressure_stops": PRESSURE_STOPS,
    }


def files_in(folder: Path) -> dict[str, list[str]]:
    """Motor files and studies of the folder, by their names."""
    motors = sorted(each.name for each in folder.glob("*.toml") if each.is_file())
    studies = sorted(each.parent.name for each in folder.glob(f"*/{DATABASE_NAME}"))
    return {"motors": motors[:MOST_FILES], "studies": studies[:MOST_FILES]}


def point_words(point: OperatingPoint) -> str:
    """What an operating point is called on the page: as in the report."""
    return name_of(point)


def _points(session: Session) -> list[dict[str, Any]]:
    system = session.opened.file.system
    return [
        {
            "text": point_words(each),
            "reverse": each.reverse,
            "idle": list(each.idle_lobes),
            "order": in_mode(system.motor, each.idle_lobes).surviving_order,
        }
        for each in system.operating_points
    ]


def _cam(session: Session) -> dict[str, Any]:
    opened = session.opened
    hand, motor = opened.hand, opened.file.system.motor
    stroke = float(np.ptp(hand.given))
    space = opened.file.design_space
    modes = None if space is None else space.cam
    bounds = {}
    if modes is not None:
        bounds = dict(zip(modes.names, np.asarray(modes.bounds()).tolist(), strict=True))
    mirrored = np.roll(hand.given[::-1], 1)
    return {
        "count": len(hand.given),
        "lobes": hand.lobes,
        "period": 360.0 / motor.cam.repeats,
        "symmetric": bool(np.max(np.abs(hand.given - mirrored)) < 1e-6 * max(stroke, 1e-9)),
        "mirror": modes.mirror if modes is not None else True,
        "keep": modes.keep_displacement if modes is not None else True,
        "free": list(bounds),
        "modes": [
            {
                "path": f"cam.{kind}.{k}",
                "kind": kind,
                "number": k,
                "value": value,
                "reach": bounds.get(f"cam {kind} {k}", MODE_SHARE * stroke / k**2),
                "free": f"cam {kind} {k}" in bounds,
            }
            for kind, k, value in hand.modes()
            if k > 1 or hand.lobes > 1 or kind == "cos"
        ],
    }


def _limits(session: Session) -> list[dict[str, Any]]:
    file = session.opened.file
    known = limits_set(file.goal.constraints, file.system)
    found = []
    for name in file.goal.constraints.names():
        limit = known[name]
        quantity = QUANTITIES.get(limit.result)
        bound = limit.bound if quantity is None else quantity.value(limit.bound)
        unit = "" if quantity is None else quantity.unit
        found.append(
            {
                "name": name,
                "label": plain_name(name),
                "result": limit.result,
                "upper": limit.upper,
                "text": f"{'at most' if limit.upper else 'at least'} {bound:.4g} {unit}".rstrip(),
            }
        )
    return found


def _envelope(where: Range | None) -> dict[str, Any] | None:
    if where is None:
        return None
    return {"asked": where.asked, "coarse": _grid(where.coarse), "fine": _grid(where.fine)}


def _grid(grid: EnvelopeGrid) -> dict[str, Any]:
    return {
        "speed": (grid.shaft_speed * 30 / math.pi).tolist(),
        "pressure": (grid.supply_pressure / 1e5).tolist(),
        "return": (grid.return_pressure / 1e5).tolist(),
        "backwards": grid.backwards.tolist(),
        "fluid": np.asarray(grid.fluid).tolist(),
    }
