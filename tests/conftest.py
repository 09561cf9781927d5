"""Shared by all tests: helper modules beside this file, and one hypothesis profile."""

import sys
from pathlib import Path

from hypothesis import HealthCheck, settings

sys.path.insert(0, str(Path(__file__).parent))

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
