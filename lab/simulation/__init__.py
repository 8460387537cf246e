"""Simulated homes with exact truth, cameras and sensors in them, walks through them, and a robot.

Open3D is needed only once a home is rendered; the small `SimulatedRoom` does without it.
"""

from lab.simulation.camera import pose_looking
from lab.simulation.detecting import Sight, onboard_detections
from lab.simulation.ground import Ground
from lab.simulation.home import Home
from lab.simulation.renderer import Renderer, RenderParams
from lab.simulation.robot import SimulatedRobot
from lab.simulation.room import SimulatedObject, SimulatedRoom
from lab.simulation.sensor import NO_NOISE, Sensor, SensorParams
from lab.simulation.small_house import load_small_house
from lab.simulation.tour import TourParams, walk_through
from lab.simulation.world import HOME_CAMERA, HomeWorld, HomeWorldParams, World
from lab.simulation.writing import recorded_frames, write_home_recording, write_recording

__all__ = [
    "HOME_CAMERA",
    "NO_NOISE",
    "Ground",
    "Home",
    "HomeWorld",
    "HomeWorldParams",
    "RenderParams",
    "Renderer",
    "Sensor",
    "SensorParams",
    "Sight",
    "SimulatedObject",
    "SimulatedRobot",
    "SimulatedRoom",
    "TourParams",
    "World",
    "load_small_house",
    "onboard_detections",
    "pose_looking",
    "recorded_frames",
    "walk_through",
    "write_home_recording",
    "write_recording",
]
