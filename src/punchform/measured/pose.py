"""Where a part lies in the axes of its measurement, Eq. (10.1)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from punchform.arrays import Floats


@dataclass(frozen=True)
class Pose:
    """Eq. (10.1): a point x of the run lies at turn @ x + shift in the measurement.

    turn (3, 3), a rotation; shift (3,) [mm]: where the middle of the rim plane (the run's origin) was measured.
    """

    turn: Floats
    shift: Floats

    def to_run(self, measured: Floats) -> Floats:
        """Measured points (N, 3) in the axes of the run: the alignment."""
        return np.asarray((measured - self.shift) @ self.turn)

    def to_measured(self, points: Floats) -> Floats:
        """Points (N, 3) of the run in the axes of the measurement."""
        return np.asarray(points @ self.turn.T + self.shift)

    def moved(self, step: Floats) -> Pose:
        """The pose after a small motion (6,) in the axes of the run: shift [mm], then turn [rad]."""
        turn = self.turn @ rotation(step[3:])
        return Pose(turn, self.shift + self.turn @ step[:3])

    @property
    def rotation_vector(self) -> Floats:
        """The turn as axis times angle (3,) [rad]; the same in the axes of run and measurement."""
        return rotation_vector(self.turn)

    @property
    def tilt(self) -> float:
        """Angle between the axes of the part in run and measurement [rad]; more than 90 degrees is upside down."""
        return math.acos(float(np.clip(self.turn[2, 2], -1.0, 1.0)))


def unmoved() -> Pose:
    """The pose of a cloud that is measured in the axes of the run."""
    return Pose(np.eye(3), np.zeros(3))


def rotation(vector: Floats) -> Floats:
    """The rotation matrix (3, 3) of axis times angle (3,) [rad]."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_rotvec(vector).as_matrix(), dtype=np.float64)


def rotation_vector(turn: Floats) -> Floats:
    """Axis times angle (3,) [rad] of a rotation matrix."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_matrix(turn).as_rotvec(), dtype=np.float64)


def shortest_turn(axis: Floats) -> Floats:
    """The rotation matrix that takes the unit vector `axis` to +z by the smallest angle; about x for -z itself."""
    if axis[2] < -1 + 1e-12:
        return np.diag([1.0, -1.0, -1.0])
    cross = np.array([axis[1], -axis[0], 0.0])
    sine = float(np.linalg.norm(cross))
    return rotation(cross * (math.atan2(sine, float(axis[2])) / sine)) if sine > 0 else np.eye(3)
