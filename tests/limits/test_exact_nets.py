"""The exact nets themselves: against independent files, their equal edges, and the closed forms of section 6."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from exact_nets import Dome, chords_of_parabola, paraboloid, paraboloid_net, sphere, sphere_net, translated

from punchform.arrays import Floats

REFERENCE = Path(__file__).parents[1] / "net" / "reference"
DIAGONAL_SHEAR = {30: 7.5204, 45: 16.1128, 60: 26.9456, 75: 39.2695, 90: 52.4251}
"""Eq. (6.4): shear on the diagonal [deg] by colatitude [deg]."""


def quarter_of(name: str) -> Floats:
    """The quarter u, v >= 0 of a reference net, (n, n, 3)."""
    table = np.loadtxt(REFERENCE / f"{name}.csv", delimiter=",", skiprows=1)
    side = int(table[:, 0].max()) + 1
    return table[:, 2:].reshape(side, side, 3)[side // 2 :, side // 2 :]


def shear(net: Floats) -> Floats:
    """Right angle less the angle between the wires, at the inner nodes [rad]: central differences."""
    first, second = net[2:, 1:-1] - net[:-2, 1:-1], net[1:-1, 2:] - net[1:-1, :-2]
    lengths = np.linalg.norm(first, axis=2) * np.linalg.norm(second, axis=2)
    return np.asarray(np.arcsin(np.sum(first * second, axis=2) / lengths))


def test_sphere_net_of_an_independent_program() -> None:
    np.testing.assert_allclose(sphere_net(1.0, 0.1, 9), quarter_of("net_sphere_R1_chord0.1"), atol=1e-11)


def test_paraboloid_net_of_an_independent_program() -> None:
    x = chords_of_parabola(0.5, 0.05, 17, first=0.025)
    np.testing.assert_allclose(translated(x, 0.5), quarter_of("net_paraboloid_f0.5_chord0.05"), atol=1e-11)


@pytest.mark.parametrize("dome", [sphere(100.0), paraboloid(50.0)], ids=["sphere", "paraboloid"])
def test_every_edge_is_the_chord_and_every_node_is_on_the_surface(dome: Dome) -> None:
    net = dome.net(7.0, 12)
    for axis in range(2):
        np.testing.assert_allclose(np.linalg.norm(np.diff(net, axis=axis), axis=2), 7.0, rtol=1e-13)
    np.testing.assert_allclose(dome.surface.gap(net.reshape(-1, 3)).value, 0.0, atol=1e-12)


def test_shear_of_the_paraboloid_net() -> None:
    """Eq. (6.2), reached at order 2 in the step."""
    errors = []
    for count in (10, 20, 40):
        net = paraboloid_net(0.5, 1.0 / count, count)
        x, y = net[1:-1, 1:-1, 0], net[1:-1, 1:-1, 1]
        wanted = np.arcsin(x * y / np.sqrt((1 + x**2) * (1 + y**2)))
        errors.append(np.abs(shear(net) - wanted).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize(("colatitude", "wanted"), DIAGONAL_SHEAR.items())
def test_shear_on_the_diagonal_of_the_sphere_net(colatitude: int, wanted: float) -> None:
    """Eq. (6.4), to the digits of the theory page once the step is small."""
    net = sphere_net(1.0, 0.005, 260)
    diagonal = np.arange(1, 260)
    polar = np.degrees(np.arccos(net[diagonal, diagonal, 2]))
    found = np.degrees(np.abs(shear(net)[diagonal - 1, diagonal - 1]))
    assert np.interp(colatitude, polar, found) == pytest.approx(wanted, abs=2e-3)
