"""A small simulated home with exact truth, a walk through it, and a robot that detects on board."""

from lab.simulation.camera import pose_looking
from lab.simulation.detecting import onboard_detections
from lab.simulation.robot import SimulatedRobot
from lab.simulation.room import SimulatedObject, SimulatedRoom
from lab.simulation.writing import recorded_frames, write_recording

__all__ = [
    "SimulatedObject",
    "SimulatedRobot",
    "SimulatedRoom",
    "onboard_detections",
    "pose_looking",
    "recorded_frames",
    "write_recording",
]
