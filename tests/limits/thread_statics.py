"""Statics of a pulled net of threads on a frictionless surface: tensions from the balance of forces at the nodes.

A quarter net of n × n cells has 2 n (n + 1) threads between crossings and as many balances along the surface: two at a
node inside, one on a mirror plane, none at the apex. So the tensions follow from the positions alone, without any
elasticity: the exact answer of the discrete net, to which an elastic grid must tend.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.linalg import spsolve

from punchform.arrays import Floats


def tensions(net: Floats, normals: Floats, pulls: tuple[Floats, Floats], *, edge: float = 1.0) -> tuple[Floats, Floats]:
    """Tensions of both families, (n, n + 1) and (n + 1, n), indexed by the node (i, j) where the element starts.

    net, normals (n + 1, n + 1, 3); pulls: directions of the unit pull at the ends (n, j) of the first family and
    (i, n) of the second, (n + 1, 3) each; edge: size of the pull on the two threads that are the edge itself.
    """
    n = len(net) - 1
    balances = np.array([row for i in range(n + 1) for j in range(n + 1) for row in _ways(i, j, normals[i, j], n)])
    node, way = balances[:, 0].astype(int), balances[:, 1:]
    forces = _forces(net)
    matrix = coo_array((np.ones(len(node)), (np.arange(len(node)), node)), shape=(len(node), (n + 1) ** 2)).tocsr()
    along = sum(coo_array(matrix @ forces[c]).multiply(way[:, c, None]) for c in range(3))
    loads = _loads(n, pulls, edge)
    found = spsolve(along.tocsc(), -np.sum(loads[node] * way, axis=1))
    half = n * (n + 1)
    return found[:half].reshape(n, n + 1), found[half:].reshape(n + 1, n)


def _ways(i: int, j: int, normal: Floats, n: int) -> list[Floats]:
    """Node number and direction along the surface of each balance that the mirror planes leave at node (i, j)."""
    along_x = np.cross((0.0, 1.0, 0.0), normal)
    along_y = np.cross(normal, (1.0, 0.0, 0.0))
    kept = [along_x] * (i > 0) + [along_y] * (j > 0)
    return [np.concatenate(([i * (n + 1) + j], way / np.linalg.norm(way))) for way in kept]


def _forces(net: Floats) -> list[coo_array]:
    """Force on each node (rows) from a unit tension in each thread (columns), for x, y and z."""
    n = len(net) - 1
    number = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    start = np.concatenate((number[:-1].ravel(), number[:, :-1].ravel()))
    end = np.concatenate((number[1:].ravel(), number[:, 1:].ravel()))
    chord = net.reshape(-1, 3)[end] - net.reshape(-1, 3)[start]
    share = np.concatenate((np.tile(_share(n), n), np.repeat(_share(n), n)))
    force = share[:, None] * chord / np.linalg.norm(chord, axis=1, keepdims=True)
    thread = np.arange(len(start))
    rows, columns = np.concatenate((start, end)), np.concatenate((thread, thread))
    return [coo_array((np.concatenate((f, -f)), (rows, columns))).tocsr() for f in force.T]


def _loads(n: int, pulls: tuple[Floats, Floats], edge: float) -> Floats:
    """Pull on the nodes, ((n + 1)², 3): half on the thread in a mirror plane, `edge` on the thread along the edge."""
    size = _share(n)
    size[-1] = edge
    loads = np.zeros((n + 1, n + 1, 3))
    loads[n] += size[:, None] * pulls[0]
    loads[:, n] += size[:, None] * pulls[1]
    return loads.reshape(-1, 3)


def _share(n: int) -> Floats:
    share = np.ones(n + 1)
    share[0] = 0.5
    return share
