"""One program where a function is asked by itself, and nothing within a traced one."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from motor_files import with_line

from camring.files.motor import parse_motor_file
from camring.geometry.cam import RadialCam
from camring.numerics.compilation import one_program
from camring.objective.theory import theory_designs


def smooth(x, scale):
    return scale * jnp.sin(x) + jnp.exp(-(x**2)) * jnp.roll(x, 1)


MADE = []
jax.monitoring.register_event_duration_secs_listener(  # for good: older JAX cannot take one back
    lambda event, duration, **_: (
        MADE.append(event) if event.endswith("backend_compile_duration") else None
    )
)


@pytest.fixture
def compiled():
    """How many programs JAX has made since."""
    MADE.clear()
    return MADE


def test_within_a_traced_function_nothing_is_changed():
    x = np.linspace(0, 1, 7)
    plain, marked = (
        jax.make_jaxpr(jax.grad(lambda x, f=f: jnp.sum(f(x, 2.0))))(x)
        for f in (smooth, one_program(smooth))
    )
    assert str(plain) == str(marked)


def test_a_cam_asked_alone_is_one_program_and_another_cam_is_the_same(compiled):
    angle = np.linspace(0, 1, 37)  # a shape that no other test asks for
    first, second = (RadialCam(0.1 + 0.01 * np.arange(k, k + 11) % 3, repeats=4) for k in (0, 1))
    of_first = first.pitch_radius(angle)
    assert len(compiled) == 1
    of_second = second.pitch_radius(angle)
    assert len(compiled) == 1
    assert not np.array_equal(of_first.value, of_second.value)
    step_by_step = eqx.filter_jit(lambda cam: RadialCam.pitch_radius.__wrapped__(cam, angle))
    np.testing.assert_allclose(of_first.value, step_by_step(first).value, rtol=1e-15)


def test_theory_and_texts_of_another_motor_compile_nothing(compiled):
    """Numbers in the text of a program would make another one for every motor file."""
    texts = []
    for line in ('dead_volume = "5 cm^3"', 'dead_volume = "7 cm^3"'):
        file = parse_motor_file(with_line(line))
        before = len(compiled)
        points = theory_designs(file.system, file.design_space, file.goal.constraints)
        texts.append(file.with_design(points[0].tolist()))
    assert before == len(compiled) > 0
    assert texts[0] != texts[1]
