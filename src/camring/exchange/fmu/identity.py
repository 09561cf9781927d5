"""What an exported motor is called where only letters, digits and underscores may stand."""

import re

from camring.files.motor import MotorFile
from camring.studies.study_folder import BEST_NAME

__all__ = ["identifier"]

_WORDS_OF_C_AND_MODELICA = (
    "algorithm and annotation assert auto block bool boolean break case char class connect "
    "connector const constant constrainedby continue default der discrete do double each else "
    "elseif elsewhen encapsulated end enum enumeration equation expandable extends extern external "
    "false final float flow for function goto if import impure in initial inline inner input int "
    "integer long loop main model modelica not operator or outer output package parameter partial "
    "protected public pure real record redeclare register replaceable restrict return short signed "
    "sizeof static stream string struct switch table then true type typedef union unsigned void "
    "volatile when while within"
)


def identifier(file: MotorFile) -> str:
    """From the motor file's name; from its folder's for the best motor of a study."""
    path = file.path
    name = path.resolve().parent.name if path.name == BEST_NAME else path.stem
    name = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_") or "motor"
    if not name[0].isalpha() or name.lower() in _WORDS_OF_C_AND_MODELICA.split():
        name = f"motor_{name}"
    return name
