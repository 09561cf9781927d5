"""Shared by all tests: helper modules beside this file, and one hypothesis profile."""

import ctypes
import gc
import os
import resource
import shutil
import signal
import sys
import tempfile
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from camring.programs.compilation_cache import PROGRAMS, SWITCH, keep_compiled_programs

sys.path.insert(0, str(Path(__file__).parent))

gc.set_threshold(50_000)  # as the command line does

# Two workers on two cores: linear algebra that spins in both makes each wait for the other.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# Tests in the background of a shell ignore Ctrl-C, and so would the commands that they start.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# JAX compiles on first use, so time limits for one example mean nothing; the
# examples are the same on every machine, so that a red test is red for everyone.
settings.register_profile(
    "camring",
    deadline=None,
    derandomize=True,
    print_blob=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
settings.load_profile("camring")


# Memory that a process of tests may hold, after a file or within one, before it gives its programs
# back: compiling takes as much as 0.6 GB for a moment. Every one also keeps some memory maps; Linux
# allows a process 65,530, and XLA does not survive the refusal of one more.
MOST_BYTES = 700_000_000
GROWN = 300_000_000  # since it did so last: what does not go is no reason to compile all else again
MOST_BYTES_IN_A_FILE = 1_200_000_000
MOST_MAPS = 30_000
MAPS, SIZES = Path("/proc/self/maps"), Path("/proc/self/statm")


def resident_bytes() -> int:
    pages = int(SIZES.read_text().split()[1]) if SIZES.exists() else 0
    return pages * resource.getpagesize()


@pytest.fixture(autouse=True, scope="session")
def _private_state(tmp_path_factory):
    """What camring remembers of its user outside every study, such as a consent."""
    os.environ["XDG_STATE_HOME"] = str(tmp_path_factory.mktemp("state"))


@pytest.fixture(autouse=True, scope="module")
def _forget_programs():
    """Between two files of tests; what is needed again comes from the folder on disk."""
    yield
    many = MAPS.exists() and MAPS.read_bytes().count(b"\n") > MOST_MAPS
    if many or resident_bytes() > max(MOST_BYTES, _left[-1] + GROWN):
        forget()


@pytest.fixture(autouse=True)
def _forget_programs_of_a_large_file():
    yield
    if resident_bytes() > MOST_BYTES_IN_A_FILE:
        forget()


def forget() -> None:
    import jax

    from camring.programs.kept_program import forget_programs

    jax.clear_caches()
    forget_programs()
    gc.collect()
    if sys.platform == "linux":
        ctypes.CDLL(None).malloc_trim(0)
    _left.append(resident_bytes())


_left = [0]  # bytes, each time


@pytest.fixture(autouse=True)
def _same_folder(monkeypatch):
    """A command run in this process may say that programs are kept elsewhere, or nowhere."""
    monkeypatch.setenv(PROGRAMS, os.environ[PROGRAMS])


@pytest.fixture(scope="session")
def simulated():
    """One motor simulated at two speeds, for all tests of what is written about it."""
    import equinox as eqx
    import motors

    from camring.physics.system import System
    from camring.programs.compiled import simulate

    case = motors.sound_case(0)
    slow = eqx.tree_at(lambda p: p.shaft_speed, case.point, case.point.shaft_speed / 2)
    system = System(case.motor, case.fluid, (case.point, slow))
    cycles = [simulate(system.motor, system.fluid, point) for point in system.operating_points]
    return system, cycles


# A structure's programs run for some ten motors: their compilation is what costs.
# Code in one piece costs a tenth less than in pieces for several processors, which are busy here.
QUICKLY_COMPILED = (
    "--xla_backend_optimization_level=0 --xla_cpu_use_fusion_emitters=false"
    " --xla_cpu_parallel_codegen_split_count=1"
)
CACHE_HOME = "XDG_CACHE_HOME"
_cache_folder: list[str] = []


def pytest_configure(config):
    """One folder of compiled programs for all processes of this run: workers and commands.

    `CAMRING_TESTS_CACHE` names one to begin with and to leave behind.
    """
    if not hasattr(config, "workerinput"):
        if "CAMRING_TESTS_CACHE" not in os.environ:
            _cache_folder.append(tempfile.mkdtemp(prefix="camring-tests-"))
        os.environ[CACHE_HOME] = os.environ.get("CAMRING_TESTS_CACHE") or _cache_folder[0]
        os.environ.pop(SWITCH, None)
        os.environ["XLA_FLAGS"] = f"{os.environ.get('XLA_FLAGS', '')} {QUICKLY_COMPILED}".strip()
    keep_compiled_programs()


def pytest_unconfigure(config):
    for folder in _cache_folder:
        shutil.rmtree(folder, ignore_errors=True)
