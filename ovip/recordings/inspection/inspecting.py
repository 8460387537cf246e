"""All checks of a recording, one after another, on at most a hundred of its frames."""

from __future__ import annotations

from ovip.recordings.inspection.agreement import check_agreement, choose_pairs
from ovip.recordings.inspection.camera import check_depth, check_intrinsics, check_up
from ovip.recordings.inspection.finding import Finding
from ovip.recordings.inspection.path import check_frames, check_path, check_times
from ovip.recordings.inspection.registration import check_registration
from ovip.recordings.inspection.views import Views, spread
from ovip.recordings.recording import Recording

SAMPLES = 20


def inspect_recording(recording: Recording) -> tuple[Finding, ...]:
    """What there is to say of `recording`; the same recording gives the same answer."""
    views, times, names = Views(recording), recording.timestamps(), recording.names()
    some = sorted({*spread(len(views), SAMPLES), *(at for pair in choose_pairs(views.poses) for at in pair)})
    seen = views.all_at(some)
    findings = (
        check_frames(recording),
        check_times(times, names),
        check_path(views.poses, times, names),
        check_intrinsics(recording.intrinsics),
        check_depth([view for _, view in seen], recording.depth_scale),
        check_agreement(views, recording.depth_scale),
        check_up(
            [(views.poses[at], view) for at, view in seen[:: max(1, len(seen) // SAMPLES)]],
            views.k,
            recording.world_from_source,
        ),
        check_registration(views),
    )
    return (*findings, *_undecoded(views))


def _undecoded(views: Views) -> list[Finding]:
    broken = views.undecoded
    if not broken:
        return []
    told = ", ".join(views.name(at) for at in broken[:5]) + (", .." if len(broken) > 5 else "")
    return [Finding("images", "wrong", f"{len(broken)} of the frames looked at do not decode: {told}")]
