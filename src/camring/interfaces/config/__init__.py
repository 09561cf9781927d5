"""The motor file: read once, at the edge (model.md section 9)."""

from camring.interfaces.config.motor_file import (
    MotorFile,
    missing_design_space,
    missing_tolerances,
    parse_motor_file,
    read_motor_file,
)

__all__ = [
    "MotorFile",
    "missing_design_space",
    "missing_tolerances",
    "parse_motor_file",
    "read_motor_file",
]
