"""The 3D viewer of the report: what it shows of a run, packed into the page. The program itself is in viewer/src."""

from punchform.report.viewer.embedded import program, style
from punchform.report.viewer.of_others import scene_of_net, scene_of_shell
from punchform.report.viewer.of_run import scene_of
from punchform.report.viewer.payload import Packed, pack
from punchform.report.viewer.scene import Figure, Mark, Pose, Quantity, Scene, Skin

__all__ = [
    "Figure",
    "Mark",
    "Packed",
    "Pose",
    "Quantity",
    "Scene",
    "Skin",
    "pack",
    "program",
    "scene_of",
    "scene_of_net",
    "scene_of_shell",
    "style",
]
