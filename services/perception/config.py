"""Settings of perception."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from pydantic import Field, field_validator

from ovip.config import KernelSettings


class Settings(KernelSettings):
    """What detects, how strictly, and how many frames may wait."""

    perception_port: int = Field(
        50051, ge=0, le=65535, description="port perception listens on; 0: any free one"
    )
    models: Literal["embedded", "given", "full"] = Field(
        "embedded", description="embedded: small CPU models; given: robots send detections; full: GPU models"
    )
    models_dir: Path = Field(
        Path("~/.cache/ovip/models").expanduser(), description="where `ovip models pull` puts weight files"
    )
    enumerator: Literal["auto", "detector", "vlm"] = Field(
        "auto",
        description="who names what is visible; auto: the VLM where one is configured, else the detector",
    )
    gate_n_min: int = Field(3, ge=1, description="frames that must name a word before it is looked for")
    gate_blacklist: str = Field(
        "", description="words never looked for, comma-separated, besides the built-in ones"
    )
    min_confidence: float = Field(0.35, ge=0, le=1, description="least detector score")
    max_depth: float = Field(6.0, gt=0, description="metres beyond which depth is not trusted")
    window: int = Field(
        16, ge=1, description="frames of one stream that may be in flight before they are durable"
    )
    max_backlog: int = Field(
        256, ge=1, description="unprocessed frames of a scene at which robots are slowed down"
    )
    full_grounder: str = Field(
        "IDEA-Research/grounding-dino-base", description="hub name or directory, for models=full"
    )
    full_segmenter: str = Field(
        "facebook/sam2.1-hiera-small", description="hub name or directory, for models=full"
    )
    full_encoder: str = Field(
        "laion/CLIP-ViT-H-14-laion2B-s32B-b79K", description="hub name or directory, for models=full"
    )
    second_encoder: str = Field(
        "",
        description="hub name or directory of a DINO whose features may veto merges, beside any models; empty: none",
    )
    full_device: str = Field("cuda", description="torch device, for models=full and the second encoder")

    @property
    def port(self) -> int:
        """The port to listen on."""
        return self.perception_port

    @field_validator("models_dir")
    @classmethod
    def _models_home(cls, path: Path) -> Path:
        return path.expanduser()
