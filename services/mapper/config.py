"""Settings of the mapper."""

from __future__ import annotations

from pydantic import Field

from ovip.config import KernelSettings
from services.mapper.domain.association import AssociationParams
from services.mapper.domain.fusion import FusionParams, Weighting
from services.mapper.domain.params import MapParams
from services.mapper.domain.spatial import Spatial
from services.mapper.domain.upkeep import UpkeepParams

_UPKEEP = UpkeepParams()
_ASSOCIATION = AssociationParams()


class Settings(KernelSettings):
    """How detections become objects, and how often the map is written down."""

    mapper_port: int = Field(50052, ge=0, le=65535, description="port the mapper listens on; 0: any free one")
    tau: float = Field(
        _ASSOCIATION.tau, description="association score that a detection must exceed to join an object"
    )
    alpha: float = Field(
        _ASSOCIATION.alpha, ge=-1, le=1, description="weight of shape against appearance (paper: 0)"
    )
    label_penalty: float = Field(
        _ASSOCIATION.label_penalty, ge=0, description="what a differing label costs (paper's w_L: 0.5)"
    )
    spatial: Spatial = Field(
        _ASSOCIATION.spatial, description="spatial term of the score: iou (the paper's), giou or overlap"
    )
    fusion: Weighting = Field(
        FusionParams().weighting, description="what a view weighs: view-area (the paper's), area or count"
    )
    upkeep_every: int = Field(_UPKEEP.every, ge=1, description="detection batches between upkeeps")
    confirm_frames: int = Field(
        _UPKEEP.confirm_frames, ge=1, description="frames that must see an object to believe it"
    )
    snapshot_every: int = Field(50, ge=1, description="map versions between snapshots")
    settle_after_s: float = Field(
        0.0, ge=0, description="seconds without a frame after which the last ones get their upkeep; 0: never"
    )

    @property
    def port(self) -> int:
        """The port to listen on."""
        return self.mapper_port

    def map_params(self) -> MapParams:
        """The numbers that the domain takes."""
        return MapParams(
            association=AssociationParams(self.alpha, self.label_penalty, self.tau, self.spatial),
            fusion=FusionParams(weighting=self.fusion),
            upkeep=UpkeepParams(every=self.upkeep_every, confirm_frames=self.confirm_frames),
        )
