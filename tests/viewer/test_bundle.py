"""The program of the viewer that is committed is the one its sources make, and travels with the package."""

from __future__ import annotations

import hashlib
import json
import re
import shutil
import subprocess
from importlib.resources import files
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCES = ROOT / "viewer"
MADE = ("viewer.js", "LICENSES.txt")


def digests(folder: Path) -> dict[str, str]:
    return {name: hashlib.sha256((folder / name).read_bytes()).hexdigest() for name in MADE}


def test_the_committed_bundle_is_what_the_sources_make(tmp_path: Path) -> None:
    if shutil.which("npm") is None:
        pytest.skip("needs Node: scripts/install-test-tools installs it")
    copy = tmp_path / "viewer"
    shutil.copytree(SOURCES, copy, ignore=shutil.ignore_patterns("node_modules"))
    subprocess.run(["npm", "ci", "--no-audit", "--no-fund"], cwd=copy, check=True, capture_output=True)
    subprocess.run(["node", "build.js", str(tmp_path)], cwd=copy, check=True, capture_output=True)
    assert digests(tmp_path) == digests(Path(str(files("punchform.report.viewer")))), "run scripts/build-viewer"


def test_versions_are_exact_and_no_address_is_locked() -> None:
    wanted = json.loads((SOURCES / "package.json").read_text("utf-8"))["devDependencies"]
    assert all(re.fullmatch(r"\d+\.\d+\.\d+", version) for version in wanted.values())
    lock = (SOURCES / "package-lock.json").read_text("utf-8")
    assert '"resolved"' not in lock
    assert {name: json.loads(lock)["packages"][f"node_modules/{name}"]["version"] for name in wanted} == wanted


def test_the_licence_of_what_is_bundled_is_beside_it() -> None:
    text = (files("punchform.report.viewer") / "LICENSES.txt").read_text("utf-8")
    version = json.loads((SOURCES / "package.json").read_text("utf-8"))["devDependencies"]["three"]
    assert f"three {version}\n" in text
    assert "The MIT License" in text
    assert "Permission is hereby granted" in text
