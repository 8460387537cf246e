"""Settings of retrieval."""

from __future__ import annotations

from pydantic import Field

from ovip.config import KernelSettings


class Settings(KernelSettings):
    """Where it listens, and the budgets of a question that names none."""

    retrieval_port: int = Field(
        50054, ge=0, le=65535, description="port retrieval listens on; 0: any free one"
    )
    retrieval_max_vlm_calls: int = Field(
        20, ge=0, description="VLM calls of one question that names no budget"
    )
    retrieval_max_viewpoints: int = Field(
        1200, ge=1, description="viewpoints of one search that names no budget"
    )
    retrieval_history_frames: int = Field(
        48, ge=3, description="history frames that tier 3 grounds for one question"
    )
    retrieval_ground_batch: int = Field(8, ge=1, le=64, description="frames grounded by one call")
    retrieval_robot_radius: float = Field(0.25, gt=0, le=2, description="metres, of a robot that names none")
    retrieval_reach: float = Field(
        3.0, gt=0.5, le=20, description="metres at which a small thing is still detected"
    )
    retrieval_balance: float = Field(
        0.5, ge=0, le=1, description="lambda: 1 searches by likelihood, 0 by distance"
    )
    retrieval_detection_rate: float = Field(
        0.7, gt=0, lt=1, description="one view's chance to detect what it sees"
    )
    retrieval_keep_answers_s: float = Field(
        86400.0, gt=0, description="seconds a plain question's answer can be read again"
    )

    @property
    def port(self) -> int:
        """The port to listen on."""
        return self.retrieval_port
