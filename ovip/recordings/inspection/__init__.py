"""Whether a recording is what it says it is, before anything is mapped: checks that answer in words."""

from ovip.recordings.inspection.finding import Finding, worst
from ovip.recordings.inspection.inspecting import inspect_recording
from ovip.recordings.inspection.sheet import draw_sheet

__all__ = ["Finding", "draw_sheet", "inspect_recording", "worst"]
