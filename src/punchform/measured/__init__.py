"""Measured shapes: read a cloud of points, align it with a run, and compare it with target and prediction."""

from punchform.measured.alignment import ALIGNMENTS, FITS, Alignment, Wish, align
from punchform.measured.cloud import Cloud
from punchform.measured.comparison import Comparison, Deviation, Predicted, compare
from punchform.measured.pose import Pose
from punchform.measured.reading import FORMATS, UNITS, read_cloud
from punchform.measured.sheet import Sheet, sheet
from punchform.measured.statistics import Statistics, statistics
from punchform.measured.target import Target, target_of

__all__ = [
    "ALIGNMENTS",
    "FITS",
    "FORMATS",
    "UNITS",
    "Alignment",
    "Cloud",
    "Comparison",
    "Deviation",
    "Pose",
    "Predicted",
    "Sheet",
    "Statistics",
    "Target",
    "Wish",
    "align",
    "compare",
    "read_cloud",
    "sheet",
    "statistics",
    "target_of",
]
