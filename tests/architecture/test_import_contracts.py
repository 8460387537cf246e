"""The import contracts of pyproject.toml bite: each is broken by an import that it forbids."""

import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("ovip", "services", "lab", "ovip_cli")
RUN = "import sys; from importlinter.cli import lint_imports; sys.exit(lint_imports(no_cache=True))"

DIRECTION = "the command line uses the lab, the lab the services, the services the kernel"
APART = "services never import one another; standalone alone knows them all"
INSIDE = "inside a service: main > server | adapters > service > config > ports > domain"
REDIS = "redis is spoken in ovip.store only"
S3 = "S3 is spoken in ovip.store only"
MODELS = "models run in services.perception.adapters only"
PROTOBUF = "protobuf types stop at the codec, the clients and the servers"
GRPC = "gRPC stops at the clients and the servers"
PURE = "the scene and the domains do no input and no output"

FORBIDDEN = [
    (DIRECTION, "ovip.scene.boxes", "services.mapper.config"),
    (DIRECTION, "services.regions.service", "lab.simulation"),
    (DIRECTION, "lab", "ovip_cli.app"),
    (APART, "services.mapper.service", "services.regions.ports"),
    (APART, "services.mapper.config", "services.standalone.config"),
    (INSIDE, "services.mapper.service", "services.mapper.server"),
    (INSIDE, "services.perception.worker", "services.perception.adapters.model_cache"),
    (INSIDE, "services.perception.domain.gate", "services.perception.ports"),
    (INSIDE, "services.regions.ports", "services.regions.config"),
    (INSIDE, "services.retrieval.config", "services.retrieval.tiers"),
    (INSIDE, "services.api.adapters.backends", "services.api.server.app"),
    (REDIS, "services.mapper.service", "redis"),
    (REDIS, "ovip.clients", "redis"),
    (S3, "ovip.recordings.recording", "boto3"),
    (MODELS, "services.perception.service", "torch"),
    (MODELS, "services.retrieval.service", "onnxruntime"),
    (PROTOBUF, "services.mapper.domain.fusion", "ovip.v1.types_pb2"),
    (PROTOBUF, "services.regions.service", "google.protobuf"),
    (GRPC, "services.retrieval.service", "grpc"),
    (PURE, "services.mapper.domain.association", "asyncio"),
    (PURE, "ovip.scene.grid", "os"),
    (PURE, "services.regions.domain.partition", "ovip.store"),
]


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A copy of the packages and their contracts, to be spoilt."""
    for package in PACKAGES:
        shutil.copytree(
            ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__", "static")
        )
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    return tmp_path


def lint(tree: Path) -> str:
    """What import-linter says of a tree, on long lines."""
    environment = {**os.environ, "COLUMNS": "300", "PYTHONPATH": str(tree)}
    done = subprocess.run(
        [sys.executable, "-c", RUN], cwd=tree, env=environment, capture_output=True, text=True, check=False
    )
    return done.stdout + done.stderr


def file_of(module: str, tree: Path) -> Path:
    path = tree / module.replace(".", "/")
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


def test_every_contract_is_broken_by_what_it_forbids_and_names_the_import(tree: Path) -> None:
    for _, importer, imported in FORBIDDEN:
        with file_of(importer, tree).open("a") as file:
            file.write(f"\nimport {imported}\n")
    said = lint(tree)
    unbroken = [contract for contract, _, _ in FORBIDDEN if f"{contract} BROKEN" not in said]
    unnamed = [
        (contract, importer, imported)
        for contract, importer, imported in FORBIDDEN
        if f"{importer} -> {'google' if imported == 'google.protobuf' else imported} (" not in said
    ]
    assert (unbroken, unnamed) == ([], []), said


def test_a_new_module_of_a_service_must_be_given_a_layer(tree: Path) -> None:
    (tree / "services/mapper/surprise.py").touch()
    said = lint(tree)
    assert f"{INSIDE} BROKEN" in said
    assert "services.mapper.surprise" in said


def test_a_new_service_must_be_listed(tree: Path) -> None:
    (tree / "services/surprise").mkdir()
    (tree / "services/surprise/__init__.py").touch()
    assert f"{APART} BROKEN" in lint(tree)


def test_every_contract_is_tried_here() -> None:
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    assert {contract["name"] for contract in contracts} == {contract for contract, _, _ in FORBIDDEN}
