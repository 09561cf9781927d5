"""An FMU's shared library called by ctypes, as an importer would; no FMPy needed."""

import ctypes
import zipfile
from ctypes import CFUNCTYPE, Structure, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p

OK, WARNING, DISCARD, ERROR = range(4)
NAMES = ("speed", "supplyPressure", "returnPressure", "casePressure", "torque", "supplyFlow",
         "returnFlow", "caseFlow", "angle", "initialAngle")  # fmt: skip
OUTPUTS = NAMES[4:8]
RIPPLE = len(NAMES)

_LOGGER = CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p, c_char_p)


class Callbacks(Structure):
    _fields_ = (
        ("logger", _LOGGER),
        ("allocate", c_void_p),
        ("free", c_void_p),
        ("finished", c_void_p),
        ("environment", c_void_p),
    )


class Library:
    """An unpacked FMU."""

    def __init__(self, fmu, folder):
        with zipfile.ZipFile(fmu) as archive:
            archive.extractall(folder)
        self.resources = (folder / "resources").as_uri()
        self.guid = (folder / "modelDescription.xml").read_text().split('guid="')[1].split('"')[0]
        (path,) = folder.glob("binaries/*/*")
        self.calls = ctypes.CDLL(str(path))
        self.calls.fmi2Instantiate.restype = c_void_p
        self.calls.fmi2GetVersion.restype = c_char_p
        self.calls.fmi2GetTypesPlatform.restype = c_char_p


class Slave:
    """One instance of it; `said` collects what it logs."""

    def __init__(self, library, guid=None, resources=None, kind=1, name=b"motor"):
        self.library, self.said = library, []

        def log(environment, name, status, category, form, message):
            assert form == b"%s"
            self.said.append((status, message.decode()))

        self._callbacks = Callbacks(_LOGGER(log), None, None, None, None)
        self.handle = library.calls.fmi2Instantiate(
            name, kind, (guid or library.guid).encode(),
            (resources or library.resources).encode(), ctypes.byref(self._callbacks), 0, 0,
        )  # fmt: skip

    def call(self, name, *arguments):
        return getattr(self.library.calls, name)(c_void_p(self.handle), *arguments)

    def start(self, **values):
        """To the first step, with inputs by name."""
        assert self.call("fmi2SetupExperiment", 0, c_double(0), c_double(0), 0, c_double(0)) == OK
        assert self.call("fmi2EnterInitializationMode") == OK
        self.set(**values)
        assert self.call("fmi2ExitInitializationMode") == OK
        return self

    def set(self, **values):
        numbers = [NAMES.index(name) for name in values]
        status = self.set_by_number(numbers, list(values.values()))
        assert status == OK, self.said

    def set_by_number(self, numbers, values):
        count = len(numbers)
        which, what = (c_uint * count)(*numbers), (c_double * count)(*values)
        return self.call("fmi2SetReal", which, c_size_t(count), what)

    def set_ripple(self, on):
        which, what = (c_uint * 1)(RIPPLE), (c_int * 1)(on)
        assert self.call("fmi2SetBoolean", which, c_size_t(1), what) == OK

    def get(self, *names):
        numbers = [NAMES.index(name) for name in names]
        which, what = (c_uint * len(names))(*numbers), (c_double * len(names))()
        assert self.call("fmi2GetReal", which, c_size_t(len(names)), what) == OK
        return list(what)

    def step(self, time, size):
        return self.call("fmi2DoStep", c_double(time), c_double(size), 1)

    def saved(self):
        state = c_void_p()
        assert self.call("fmi2GetFMUstate", ctypes.byref(state)) == OK
        return state

    def close(self):
        self.library.calls.fmi2FreeInstance.restype = None
        self.call("fmi2FreeInstance")


__all__ = ["ERROR", "NAMES", "OK", "OUTPUTS", "RIPPLE", "WARNING", "Library", "Slave"]
