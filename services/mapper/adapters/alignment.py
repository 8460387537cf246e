"""Alignment of two recordings of one place: every turn and shift by shape, then ICP, then a verdict."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from ovip.errors import InvalidInput, NotConfigured, Unreliable
from ovip.scene.types import F32, F64
from ovip.scene.versions import Alignment
from ovip.scene.voxels import downsample
from services.mapper.domain.joining import MOST_TILT, tilt_of, upright
from services.mapper.domain.registration import SearchParams, agreement, differ, propose


@dataclass(frozen=True, slots=True)
class AlignmentParams:
    """When an alignment is believed. voxel: metres between the points that are aligned.

    min_points: of a cloud, one a voxel. min_overlap: share of the smaller surface that must lie within `within` metres
    of the other. max_rmse: metres across the surface. min_agreement: beyond chance, where both saw something. rival: a
    clearly different placement must have less than this share of the best one's agreement.
    """

    search: SearchParams = field(default_factory=SearchParams)
    voxel: float = 0.05
    min_points: int = 1000
    within: float = 0.05
    min_overlap: float = 0.2
    max_rmse: float = 0.025
    min_agreement: float = 0.6
    rival: float = 0.9


@dataclass(frozen=True, slots=True)
class _Level:
    """One scale of ICP: points this far apart, partners this near, metres."""

    voxel: float
    reach: float


_COARSE = (_Level(0.1, 0.4), _Level(0.1, 0.2))
_FINE = (_Level(0.05, 0.15), _Level(0.05, 0.06))
_ITERATIONS = 40
_SOURCE_POINTS = 20_000  # of the moving cloud at one scale; the rest adds time, not precision


@dataclass(frozen=True, slots=True, eq=False)
class _Scale:
    """One scale of ICP made ready: Open3D clouds, the target with normals."""

    source: Any
    target: Any
    reach: float


@dataclass(frozen=True, slots=True, eq=False)
class _Placed:
    """enough: it is upright and overlaps enough, to the eye of a coarse look."""

    pose: F64
    enough: bool
    agreement: float


class IcpAligner:
    """Upright surfaces by exhaustive search over turn and shift, refined by multi-scale point-to-plane ICP (Open3D)."""

    def __init__(self, params: AlignmentParams | None = None) -> None:
        self._params = params or AlignmentParams()

    def align(self, cloud: F32, other: F32, guess: F64 | None) -> Alignment:
        """How `other` `(M, 3)` lies on `cloud` `(N, 3)`, both in metres, z up.

        guess: `(4, 4)` world_from_other, upright, to start from; then nothing else is tried. InvalidInput where a cloud
        is too small, Unreliable where there is no alignment to be believed; NotConfigured without Open3D.
        """
        o3d = _open3d()
        still, moving = self._checked(cloud, "this"), self._checked(other, "the other")
        starts = self._starts(still, moving) if guess is None else [upright(guess, "guess")]
        placed = self._settled(o3d, still, moving, starts)
        pose = _icp(o3d, _scales(o3d, still, moving, _FINE), placed[0].pose)
        found = self._judged(o3d, still, moving, pose)
        self._refuse_rivals(placed, moving)
        return found

    def _checked(self, cloud: F32, whose: str) -> F32:
        if not np.isfinite(cloud).all():
            raise InvalidInput(f"alignment: {whose} surface has points that are no numbers")
        points = downsample(np.asarray(cloud, np.float32).reshape(-1, 3), self._params.voxel)[0]
        if len(points) < self._params.min_points:
            raise InvalidInput(
                f"alignment: expected at least {self._params.min_points} points "
                f"{self._params.voxel * 100:.0f} cm apart, {whose} surface has {len(points)}"
            )
        return points

    def _starts(self, still: F32, moving: F32) -> list[F64]:
        found = [one.world_from_other for one in propose(still, moving, self._params.search)]
        if not found:
            raise Unreliable(
                "alignment: no placement of the other surface shares enough floor plan with this one"
            )
        return found

    def _settled(self, o3d: Any, still: F32, moving: F32, starts: list[F64]) -> list[_Placed]:
        """Each start after coarse ICP: those that overlap enough, the one that agrees best first."""
        scales, centre = _scales(o3d, still, moving, _COARSE), moving.mean(axis=0, dtype=np.float64)
        placed: list[_Placed] = []
        for start in starts:
            pose = _icp(o3d, scales, start)
            if not all(differ(pose, one.pose, centre, self._params.search) for one in placed):
                continue
            moved = _moved(moving, pose)
            enough = tilt_of(pose) <= MOST_TILT and (
                _overlap(still, moved, 2 * self._params.within) >= self._params.min_overlap
            )
            placed.append(_Placed(pose, enough, agreement(still, moved, self._params.search.fine)))
        return sorted(placed, key=lambda one: (not one.enough, -one.agreement))

    def _refuse_rivals(self, placed: list[_Placed], moving: F32) -> None:
        best, centre = placed[0], moving.mean(axis=0, dtype=np.float64)
        for one in placed[1:]:
            near = one.agreement > self._params.rival * best.agreement
            if one.enough and near and differ(one.pose, best.pose, centre, self._params.search):
                raise Unreliable(
                    "alignment: ambiguous, a clearly different placement is nearly as good "
                    f"(agreement {one.agreement:.2f} against {best.agreement:.2f}); a guess would decide it"
                )

    def _judged(self, o3d: Any, still: F32, moving: F32, pose: F64) -> Alignment:
        params, moved = self._params, _moved(moving, pose)
        upright(pose, "alignment")
        overlap, rmse = _fit(o3d, still, moved, params)
        agrees = agreement(still, moved, params.search.fine)
        figures = f"overlap {overlap:.2f}, agreement {agrees:.2f}, rmse {rmse * 100:.1f} cm"
        for trouble, wanted in (
            (overlap < params.min_overlap, f"an overlap of at least {params.min_overlap}"),
            (
                agrees < params.min_agreement,
                f"an agreement of at least {params.min_agreement} where both saw",
            ),
            (rmse > params.max_rmse, f"an rmse of at most {params.max_rmse * 100:.1f} cm"),
        ):
            if trouble:
                raise Unreliable(f"alignment: expected {wanted}, the best placement has {figures}")
        return Alignment(pose, overlap, rmse)


def _open3d() -> Any:
    try:
        import open3d
    except ImportError as error:
        raise NotConfigured("alignment needs Open3D: pip install 'ovip-sg[lab]'") from error
    return open3d


def _moved(points: F32, pose: F64) -> F32:
    return np.asarray(points @ pose[:3, :3].T + pose[:3, 3], np.float32)


def _scales(o3d: Any, still: F32, moving: F32, levels: tuple[_Level, ...]) -> list[_Scale]:
    made = []
    for level in levels:
        source = downsample(moving, level.voxel)[0]
        source = source[:: 1 + len(source) // _SOURCE_POINTS]
        target = _with_normals(o3d, downsample(still, level.voxel)[0], level.voxel)
        made.append(_Scale(_cloud(o3d, source), target, level.reach))
    return made


def _icp(o3d: Any, scales: list[_Scale], start: F64) -> F64:
    """`start` refined scale by scale, point to plane."""
    registration, pose = o3d.pipelines.registration, start
    for scale in scales:
        result = registration.registration_icp(
            scale.source,
            scale.target,
            scale.reach,
            pose,
            registration.TransformationEstimationPointToPlane(),
            registration.ICPConvergenceCriteria(max_iteration=_ITERATIONS),
        )
        pose = np.array(result.transformation, np.float64)
    return pose


def _overlap(still: F32, moved: F32, within: float) -> float:
    """Share of the smaller surface within reach of the other, by some of its points."""
    small, large = (still, moved) if len(still) <= len(moved) else (moved, still)
    some = small[:: 1 + len(small) // _SOURCE_POINTS]
    return float(np.isfinite(cKDTree(large).query(some, distance_upper_bound=within)[0]).mean())


def _fit(o3d: Any, still: F32, moved: F32, params: AlignmentParams) -> tuple[float, float]:
    """Share of the smaller surface within reach of the other, and the root mean square of its distance across it."""
    small, large = (still, moved) if len(still) <= len(moved) else (moved, still)
    distance, nearest = cKDTree(large).query(small, distance_upper_bound=params.within)
    near = np.isfinite(distance)
    if not near.any():
        return 0.0, float("inf")
    normals = np.asarray(_with_normals(o3d, large, params.voxel).normals)[nearest[near]]
    across = ((small[near] - large[nearest[near]]) * normals).sum(axis=1)
    return float(near.mean()), float(np.sqrt((across**2).mean()))


def _cloud(o3d: Any, points: F32) -> Any:
    return o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points.astype(np.float64)))


def _with_normals(o3d: Any, points: F32, voxel: float) -> Any:
    made = _cloud(o3d, points)
    made.estimate_normals(o3d.geometry.KDTreeSearchParamHybrid(radius=3 * voxel, max_nn=30))
    return made
