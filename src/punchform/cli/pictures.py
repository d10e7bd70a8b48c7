"""Where a command draws to."""

from __future__ import annotations

from pathlib import Path

from punchform.errors import InputError

_IMAGES = (".png", ".svg", ".pdf")


def picture_file(name: str, example: str) -> Path:
    """The file of a picture. Raises InputError for a format that cannot be drawn and for a folder that is not there."""
    image = Path(name)
    if image.suffix.lower() not in _IMAGES:
        raise InputError.of("the name of a picture ends in " + ", ".join(_IMAGES), where=name, hint=example)
    if not image.parent.is_dir():
        raise InputError.of(f"there is no folder {image.parent}", where=name)
    return image
