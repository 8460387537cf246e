"""The settings of regions: its port, its pace, and the numbers of KGSW."""

from __future__ import annotations

from pydantic import Field

from ovip.config import KernelSettings
from services.regions.domain.pace import PaceParams
from services.regions.domain.partition import PartitionParams, Relief


class Settings(KernelSettings):
    """What regions reads from the environment."""

    regions_port: int = Field(50053, ge=0, le=65535, description="port regions listens on; 0: any free one")
    regions_burst: int = Field(
        10, ge=1, description="changes of the map that call for a new partition at once"
    )
    regions_quiet_s: float = Field(
        2.0, ge=0, description="seconds without a change after which any change is enough"
    )
    regions_min_interval_s: float = Field(5.0, ge=0, description="least seconds between two partitions")
    regions_checkpoint_frames: int = Field(
        64, ge=1, description="frames of floor evidence between checkpoints"
    )
    regions_vlm_deadline_s: float = Field(
        60.0, gt=0, le=600, description="seconds the VLM may take to group a floor"
    )
    regions_recompute_timeout_s: float = Field(120.0, gt=0, description="seconds a caller of Recompute waits")
    regions_dilation: int = Field(
        6, ge=0, description="KGSW: cells by which not-free space is dilated (paper: 6)"
    )
    regions_marker_radius: float = Field(0.30, gt=0, description="KGSW: marker discs, metres (paper: 0.30)")
    regions_eps: float = Field(
        2.0, gt=0, description="KGSW: DBSCAN radius in mixed cores, metres (paper: 2.0)"
    )
    regions_min_core: float = Field(0.25, ge=0, description="KGSW: core threshold, square metres")
    regions_min_unknown: float = Field(
        1.0, ge=0, description="KGSW: A_min of a core without objects, square metres"
    )
    regions_relief: Relief = Field(
        Relief.ARRIVAL,
        description="KGSW: what the last watershed floods; clearance: the paper's -D; arrival: see Relief",
    )

    @property
    def port(self) -> int:
        """The port to listen on."""
        return self.regions_port

    @property
    def pace(self) -> PaceParams:
        """When to partition again."""
        return PaceParams(self.regions_burst, self.regions_quiet_s, self.regions_min_interval_s)

    @property
    def partition(self) -> PartitionParams:
        """The numbers of Algorithm 1."""
        return PartitionParams(
            dilation=self.regions_dilation,
            marker_radius=self.regions_marker_radius,
            eps=self.regions_eps,
            min_core=self.regions_min_core,
            min_unknown=self.regions_min_unknown,
            relief=self.regions_relief,
        )
