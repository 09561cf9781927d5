"""Laws that a user has written in Python files of their own.

`CAMRING_LAWS` names these files, so that every command and every worker process knows the
classes in them. Only the environment can: what a motor file says is data, and a motor file
from somebody else must not run anything.
"""

import os
import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

from camring.files.errors import InputError, quote

SWITCH = "CAMRING_LAWS"
PREFIX = "laws_of_the_user."


def import_user_laws() -> None:
    """Runs the files that the environment names, each once in a process.

    Raises
    ------
    InputError
        For a file that is not there or cannot be run.
    """
    for name in filter(None, os.environ.get(SWITCH, "").split(os.pathsep)):
        path = Path(name).resolve()
        if not any(_is_from(module, path) for module in list(sys.modules.values())):
            _run(path)


def _is_from(module: object, path: Path) -> bool:
    file = getattr(module, "__file__", None)
    return isinstance(file, str) and Path(file).name == path.name and Path(file).resolve() == path


def _run(path: Path) -> None:
    where = f"{SWITCH}, {quote(str(path))}"
    if not path.is_file():
        raise InputError(where, "is no file", "name Python files that hold your laws")
    spec = spec_from_file_location(f"{PREFIX}{path.stem}", path)
    if spec is None or spec.loader is None:
        raise InputError(where, "is no Python file", "give it a name that ends in .py")
    module = module_from_spec(spec)
    sys.modules[spec.name] = module
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        del sys.modules[spec.name]
        raise InputError(
            where, f"cannot be run ({type(error).__name__}: {error})", "mend it"
        ) from error
