"""The lock files: complete, hashed, one set of versions, and silent about where packages came from."""

import re
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[2]
EVERYDAY = ROOT / "requirements.lock"
DEV = ROOT / "requirements-dev.lock"
PIN = re.compile(
    r"^(?P<name>[a-z0-9-]+)==(?P<version>[^ ;]+)(?: ; [^\\]+)? \\\n(?P<hashes>(?:    --hash=[^\n]+\n)+)",
    re.MULTILINE,
)
TOO_LARGE = {"torch", "torchvision", "transformers", "open-clip-torch", "open3d", "open3d-cpu", "litellm"}


def pins(path: Path) -> dict[str, str]:
    return {match["name"]: match["version"] for match in PIN.finditer(path.read_text())}


def declared(*extras: str) -> list[Requirement]:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    lines = project["dependencies"] + [
        line for extra in extras for line in project["optional-dependencies"][extra]
    ]
    return [Requirement(line) for line in lines]


@pytest.mark.parametrize("path", [EVERYDAY, DEV], ids=lambda path: path.name)
def test_a_lock_is_nothing_but_versions_and_hashes(path: Path) -> None:
    left_over = PIN.sub("", path.read_text())
    assert left_over == ""
    assert all(
        re.fullmatch(r"(    --hash=sha256:[0-9a-f]{64}(?: \\)?\n)+", match["hashes"])
        for match in PIN.finditer(path.read_text())
    )


@pytest.mark.parametrize(
    ("path", "extras"),
    [(EVERYDAY, ("embedded",)), (DEV, ("embedded", "lab", "ros", "dev"))],
    ids=["everyday", "dev"],
)
def test_a_lock_has_every_declared_dependency_in_an_allowed_version(
    path: Path, extras: tuple[str, ...]
) -> None:
    locked = pins(path)
    wrong = [
        str(need)
        for need in declared(*extras)
        if not need.specifier.contains(locked.get(canonicalize_name(need.name), "0"), prereleases=True)
    ]
    assert wrong == []


def test_tests_run_on_the_very_versions_that_are_installed_every_day() -> None:
    assert pins(EVERYDAY).items() <= pins(DEV).items()


def test_the_everyday_install_carries_no_large_framework() -> None:
    assert TOO_LARGE.isdisjoint(pins(EVERYDAY))
    assert (TOO_LARGE - {"open3d", "open3d-cpu"}).isdisjoint(pins(DEV))  # the tests of the lab cast rays
