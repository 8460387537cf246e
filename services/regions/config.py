"""The settings of regions: its port, its pace, and the numbers of KGSW."""

from __future__ import annotations

from pydantic import Field

from ovip.config import KernelSettings
from services.regions.domain.pace import PaceParams
from services.regions.domain.partition import Growth, PartitionParams
from services.regions.domain.staleness import StalenessParams


class Settings(KernelSettings):
    """What regions reads from the environment."""

    regions_port: int = Field(50053, ge=0, le=65535, description="port regions listens on; 0: any free one")
    regions_quiet_s: float = Field(
        2.0, ge=0, description="seconds without a change before changes are answered by a new partition"
    )
    regions_min_interval_s: float = Field(
        5.0, ge=0, description="least seconds between two partitions, and the longest wait for quiet"
    )
    regions_stale_area: float = Field(
        0.5, ge=0, description="square metres of free space that must have changed to cut a floor again"
    )
    regions_stale_share: float = Field(
        0.01,
        ge=0,
        le=1,
        description="and the share of the floor, where that is more (5 m2 are always enough)",
    )
    regions_stale_move: float = Field(
        0.5, ge=0, description="metres that an object must have moved to cut its floor again"
    )
    regions_checkpoint_frames: int = Field(
        64, ge=1, description="frames of floor evidence between checkpoints"
    )
    regions_vlm_deadline_s: float = Field(
        60.0, gt=0, le=600, description="seconds the VLM may take to group a floor"
    )
    regions_recompute_timeout_s: float = Field(120.0, gt=0, description="seconds a caller of Recompute waits")
    regions_robot_radius: float = Field(
        0.25, gt=0, le=2, description="radius of a robot that asks for a way and names none, metres"
    )
    regions_dilation: int = Field(
        9,
        ge=0,
        description="KGSW: cells by which not-free space is dilated (paper: 6; 9 close a door of 0.9 m)",
    )
    regions_marker_radius: float = Field(0.30, gt=0, description="KGSW: marker discs, metres (paper: 0.30)")
    regions_eps: float = Field(
        2.0, gt=0, description="KGSW: DBSCAN radius in mixed cores, metres (paper: 2.0)"
    )
    regions_min_core: float = Field(0.25, ge=0, description="KGSW: core threshold, square metres")
    regions_min_unknown: float = Field(
        1.0, ge=0, description="KGSW: A_min of a core without objects, square metres"
    )
    regions_votes: float = Field(
        2.0,
        ge=0,
        description="KGSW: votes that a seed group of a mixed core needs, at most one an object (paper: 0)",
    )
    regions_vote_share: float = Field(
        0.1, ge=0, le=1, description="KGSW: or this share of its core's votes, where those are few"
    )
    regions_sparse: float = Field(
        15.0,
        ge=0,
        description="KGSW: square metres a vote above which one object with a whole vote makes a group",
    )
    regions_growth: Growth = Field(
        Growth.DISTANCE,
        description="KGSW: how the last watershed grows markers; clearance: the paper's -D; distance: see Growth",
    )
    regions_min_part: float = Field(
        4.0,
        ge=0,
        description="KGSW: square metres that a part of a mixed core needs, with growth by distance (paper: 0)",
    )
    regions_merge_width: float = Field(
        1.2,
        gt=0,
        description="KGSW: metres of shared border that make two regions of one function one (paper: inf)",
    )

    @property
    def port(self) -> int:
        """The port to listen on."""
        return self.regions_port

    @property
    def pace(self) -> PaceParams:
        """When to partition again."""
        return PaceParams(self.regions_quiet_s, self.regions_min_interval_s)

    @property
    def staleness(self) -> StalenessParams:
        """What makes a floor stale."""
        return StalenessParams(self.regions_stale_area, self.regions_stale_share, self.regions_stale_move)

    @property
    def partition(self) -> PartitionParams:
        """The numbers of Algorithm 1."""
        return PartitionParams(
            dilation=self.regions_dilation,
            marker_radius=self.regions_marker_radius,
            eps=self.regions_eps,
            min_core=self.regions_min_core,
            min_unknown=self.regions_min_unknown,
            votes=self.regions_votes,
            vote_share=self.regions_vote_share,
            sparse=self.regions_sparse,
            growth=self.regions_growth,
            min_part=self.regions_min_part,
            merge_width=self.regions_merge_width,
        )
