"""Shared by all tests: helper modules beside this file, and one hypothesis profile."""

import os
import shutil
import sys
import tempfile
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

sys.path.insert(0, str(Path(__file__).parent))

# Two workers on two cores: linear algebra that spins in both makes each wait for the other.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# Tests compile what they look at; the command line keeps its programs as it does for users.
os.environ.setdefault("CAMRING_PROGRAMS", "")

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


# Every compiled program keeps some memory maps; Linux allows a process 65,530 of them,
# and XLA does not survive the refusal of one more.
MAPS = Path("/proc/self/maps")
MOST_MAPS = 30_000


@pytest.fixture(autouse=True, scope="module")
def _forget_programs():
    """Between two files of tests; what is needed again comes from the folder on disk."""
    yield
    if MAPS.exists() and MAPS.read_bytes().count(b"\n") > MOST_MAPS:
        import jax

        from camring.interfaces.kept_program import forget_programs

        jax.clear_caches()
        forget_programs()


COMPILED = "JAX_COMPILATION_CACHE_DIR"
_own_folder: list[str] = []


def pytest_configure(config):
    """One folder of compiled programs for all worker processes of this run."""
    if not hasattr(config, "workerinput") and COMPILED not in os.environ:
        _own_folder.append(tempfile.mkdtemp(prefix="camring-tests-"))
        os.environ[COMPILED] = _own_folder[0]


def pytest_unconfigure(config):
    for folder in _own_folder:
        shutil.rmtree(folder, ignore_errors=True)
        os.environ.pop(COMPILED, None)
