"""Meshes of many orbits side by side are what they say they are, each for its member."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from camring.numerics.batch_mesh import (
    EvenSegments,
    equidistribute_batch,
    graded_batch,
    locate_round,
)
from camring.numerics.mesh import LAYER_ELEMENTS, Mesh

PERIOD, MEMBERS, SEGMENTS, EACH, ELEMENTS = 1.3, 64, 7, 5, 60
FEWER = 47  # of these elements
SHARP = 3  # breakpoints of each member, at places of its own


class Laid(NamedTuple):
    """What meshes were laid from, and what came of it."""

    given: Mesh
    given_segment: np.ndarray
    density: np.ndarray
    breakpoints: np.ndarray
    sharp: np.ndarray
    layer: np.ndarray
    whole: Mesh
    within: np.ndarray
    used: int

    @property
    def mesh(self):
        """But for elements that are left over."""
        return Mesh(*(leaf[: self.used] for leaf in self.whole))

    @property
    def ends(self):
        return np.concatenate([self.breakpoints[1:], self.breakpoints[:1] + PERIOD])

    def mass(self, position):
        """The density's integral from the first node to positions, shape (wanted, member)."""
        node = np.concatenate([self.given.start, self.breakpoints[:1] + PERIOD])
        total = np.cumsum(self.density * self.given.width, axis=0)
        total = np.concatenate([np.zeros((1, MEMBERS)), total])
        columns = [np.interp(position[:, k], node[:, k], total[:, k]) for k in range(MEMBERS)]
        return np.stack(columns, axis=-1)

    def segments(self):
        """In which segment each element lies, by counting first elements."""
        return np.cumsum(self.mesh.is_first, axis=0) - 1


@jax.jit
def lay(breakpoints, densities, sharp, layer, used):
    """From a graded mesh, and from the mesh laid from that."""
    given, segments = graded_batch(breakpoints, PERIOD, EACH), EvenSegments(EACH)
    found = []
    for density, some in zip(densities, (None, used), strict=True):
        # Half the elements evenly, as a motor's are: none is wider than half the period.
        density = density + jnp.sum(density * given.width, axis=0) / PERIOD
        number = segments.spread(jnp.arange(SEGMENTS)[:, None] + jnp.zeros_like(breakpoints))
        known = given, number, density
        laid = equidistribute_batch(
            given, segments, density, breakpoints, sharp, layer, PERIOD, ELEMENTS, some
        )
        found.append((*known, laid.mesh, laid.within))
        given, segments = laid.mesh, laid.segments
    return found


def laid(breakpoints, layer=1e-3, seed=0, again=False, used=ELEMENTS):
    """A mesh laid from a graded one, or once more from that."""
    rng = np.random.default_rng(seed)
    breakpoints = np.sort(breakpoints, axis=0)
    densities = [
        10 ** rng.uniform(-2, 2, (count, MEMBERS)) for count in (SEGMENTS * EACH, ELEMENTS)
    ]
    sharp = rng.permuted(np.arange(SEGMENTS)[:, None] < SHARP * np.ones(MEMBERS), axis=0) * 1.0
    layer = layer * rng.uniform(0.5, 2, (SEGMENTS, MEMBERS))

    both = jax.device_get(lay(breakpoints, densities, sharp, layer, np.full(MEMBERS, float(used))))
    given, segment, density, mesh, within = both[again]
    return Laid(given, segment, density, breakpoints, sharp, layer, mesh, within[:used], used)


def scattered(seed=1):
    return np.random.default_rng(seed).uniform(0, PERIOD, (SEGMENTS, MEMBERS))


def with_coinciding():
    """Two of them in every member, three in some, and a pair within rounding."""
    places = scattered(2)
    places[1] = places[0]
    places[2, ::3] = places[0, ::3]
    places[4] = np.nextafter(places[3], 2)
    return places


def at_the_seam():
    """One at zero, one as near to the period as there is a number."""
    places = scattered(3)
    places[0], places[1] = 0, np.nextafter(PERIOD, 0)
    places[2, ::2] = 1e-15
    return places


BREAKPOINTS = {
    "scattered": scattered(),
    "coinciding": with_coinciding(),
    "at the seam": at_the_seam(),
    "evenly spaced": np.arange(SEGMENTS)[:, None] * PERIOD / SEGMENTS + np.zeros(MEMBERS),
    "late": PERIOD * (1 - 1e-4 * np.random.default_rng(4).random((SEGMENTS, MEMBERS))),
}
LAYERS = {"thin layers": 1e-4, "layers as thick as elements": 0.5}


MESHES = {
    "from a graded mesh": {},
    "from the mesh before": {"again": True},
    "some elements left over": {"again": True, "used": FEWER},
}


@pytest.fixture(
    scope="module", params=[(b, t, m) for b in BREAKPOINTS for t in LAYERS for m in MESHES], ids=str
)
def found(request):
    places, thickness, mesh = request.param
    return laid(BREAKPOINTS[places], LAYERS[thickness], **MESHES[mesh])


def test_there_are_so_many_elements_as_were_asked_for_and_they_fill_the_period(found):
    start, width, _ = found.mesh
    assert start.shape == width.shape == found.within.shape == (found.used, MEMBERS)
    assert found.whole.start.shape == (ELEMENTS, MEMBERS)
    assert np.all(found.whole.width[found.used :] == 0)
    assert np.all(np.isfinite(start))
    assert np.all(width >= 0)
    np.testing.assert_allclose(np.sum(width, axis=0), PERIOD, rtol=1e-13)
    np.testing.assert_allclose(start[0], found.breakpoints[0], rtol=1e-15)


def test_nodes_ascend(found):
    assert np.all(np.diff(found.mesh.start, axis=0) >= -1e-15)
    ends = np.concatenate([found.mesh.start[1:], found.breakpoints[:1] + PERIOD])
    np.testing.assert_allclose(found.mesh.start + found.mesh.width, ends, atol=1e-15)


def test_every_breakpoint_is_a_node_and_is_known_as_one(found):
    assert np.all(np.sum(found.mesh.is_first, axis=0) == SEGMENTS)
    for member in range(MEMBERS):
        first = found.mesh.start[found.mesh.is_first[:, member], member]
        np.testing.assert_array_equal(first, found.breakpoints[:, member])


def test_elements_of_a_segment_hold_equal_shares(found):
    """But for the first ordinary one behind a sharp breakpoint, which gives up the layer."""
    segment, mass = found.segments(), found.mass(found.mesh.start)
    ends = found.mass(found.ends)
    for member in range(MEMBERS):
        for number in range(SEGMENTS):
            own = np.flatnonzero(segment[:, member] == number)
            thin = int(LAYER_ELEMENTS * found.sharp[number, member])
            inside = np.concatenate(
                [mass[own[0], member : member + 1], mass[own[thin + 1 :], member]]
            )
            share = np.diff(np.append(inside, ends[number, member]))
            scale = ends[-1, member] * 1e-11
            np.testing.assert_allclose(share, np.mean(share), rtol=1e-7, atol=scale)


def test_segments_have_elements_by_their_mass(found):
    """One each at least, and the layer's; what is left is shared out to within one of them."""
    segment = found.segments()
    total = found.mass(found.ends)
    for member in range(MEMBERS):
        counts = np.bincount(segment[:, member], minlength=SEGMENTS)
        own = 1 + LAYER_ELEMENTS * found.sharp[:, member]
        left = found.used - np.sum(own)
        share = np.diff(total[:, member], prepend=0) / total[-1, member]
        assert np.all(counts >= own)
        assert np.all(np.abs(counts - own - left * share) <= 1 + 1e-9)


def test_two_thin_elements_lie_behind_each_sharp_breakpoint(found):
    segment = found.segments()
    for member in range(MEMBERS):
        for number in np.flatnonzero(found.sharp[:, member]):
            own = np.flatnonzero(segment[:, member] == number)
            begin = found.breakpoints[number, member]
            nearest, nearer = found.mesh.start[own[1:3], member] - begin
            assert nearest <= 3 * found.layer[number, member] + 1e-15
            assert nearer <= 12 * found.layer[number, member] + 1e-15
            following = (
                np.append(found.mesh.start[own, member], found.ends[number, member])[3] - begin
            )
            thinnest = min(3 * found.layer[number, member], following / 8)
            assert nearest == pytest.approx(thinnest, rel=1e-6, abs=1e-14)
            thin = min(12 * found.layer[number, member], following / 2)
            assert nearer == pytest.approx(thin, rel=1e-6, abs=1e-14)


def test_it_says_truly_in_which_element_of_the_given_mesh_each_of_its_own_begins(found):
    assert np.all((found.within >= 0) & (found.within < len(found.given.start)))
    begin = np.take_along_axis(found.given.start, found.within, axis=0)
    width = np.take_along_axis(found.given.width, found.within, axis=0)
    rounding = 1e-13 * PERIOD
    assert np.all(found.mesh.start >= begin - rounding)
    assert np.all(found.mesh.start <= begin + width + rounding)
    # And within its own segment, so that nothing is looked up across a breakpoint.
    segment = np.take_along_axis(found.given_segment, found.within, axis=0)
    np.testing.assert_array_equal(segment, found.segments())


locate = jax.jit(locate_round, static_argnums=(1, 2))


@pytest.mark.parametrize("count", [16, 250, 1000])
def test_places_round_the_period_are_found_in_their_elements(found, count):
    element, fraction = jax.device_get(locate(found.mesh, count, PERIOD))
    assert element.shape == fraction.shape == (count, MEMBERS)
    assert np.all((element >= 0) & (element < found.used))
    start = np.take_along_axis(found.mesh.start, element, axis=0)
    width = np.take_along_axis(found.mesh.width, element, axis=0)
    assert np.all(fraction * width > -1e-14)
    assert np.all((fraction - 1) * width < 1e-14)
    place = np.arange(count)[:, None] * PERIOD / count
    off = (start + fraction * width - place + PERIOD / 2) % PERIOD - PERIOD / 2
    np.testing.assert_allclose(off, 0, atol=1e-14)


def test_places_on_nodes_are_where_an_element_begins_or_ends():
    """Window edges and knots stand at even places more often than chance would have it."""
    start = np.repeat(np.arange(8) * PERIOD / 8, 2)[:, None] + np.zeros(MEMBERS)
    width = np.diff(np.append(start[:, 0], PERIOD))[:, None] + np.zeros(MEMBERS)
    mesh = Mesh(start, width, np.ones((16, 1), bool))
    element, fraction = jax.device_get(locate(mesh, 32, PERIOD))
    place = np.arange(32)[:, None] * PERIOD / 32
    begin = np.take_along_axis(start, element, axis=0)
    wide = np.take_along_axis(width, element, axis=0)
    np.testing.assert_allclose(begin + fraction * wide, place + 0 * begin, atol=1e-14)
    assert np.all((fraction > -1e-12) & (fraction < 1 + 1e-12))
