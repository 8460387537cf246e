"""Recordings on disk -> posed frames, one layout a file; `open_recording` is the door."""

from ovip.recordings.folder import new_folder, write_folder
from ovip.recordings.frames import OnboardDetection, RecordedFrame, SkippedFrame
from ovip.recordings.recording import Recording
from ovip.recordings.registry import LAYOUTS, find_layout, open_recording, parse_options
from ovip.recordings.up import Up, parse_up

__all__ = [
    "LAYOUTS",
    "OnboardDetection",
    "RecordedFrame",
    "Recording",
    "SkippedFrame",
    "Up",
    "find_layout",
    "new_folder",
    "open_recording",
    "parse_options",
    "parse_up",
    "write_folder",
]
