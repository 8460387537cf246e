"""ROS 1 and ROS 2 bags as files: which topics there are, and their messages, one after another or one alone."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from ovip.errors import InvalidInput, NotConfigured

FILE_SUFFIXES = frozenset({".mcap", ".db3"})


@dataclass(frozen=True, slots=True, eq=False)
class BagMessage:
    """A message with the topic that it came on and when it was recorded, nanoseconds."""

    topic: str
    time_ns: int
    value: Any

    @property
    def stamp_ns(self) -> int:
        """When it was measured: its header's stamp; when it was recorded where that is empty."""
        stamp = self.value.header.stamp
        return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec) or self.time_ns


class Bag:
    """An open bag; it stays open as long as it lives. `topics`: name -> message type (sensor_msgs/msg/Image)."""

    def __init__(self, path: Path) -> None:
        self.path = path
        library = _library()
        with self._told():
            self._reader = library.AnyReader([path], default_typestore=_older_types())
            self._reader.open()
        self.topics: dict[str, str] = {c.topic: c.msgtype for c in self._reader.connections if c.msgcount}

    def messages(self, topics: Collection[str]) -> Iterator[BagMessage]:
        """All messages of `topics` in order of recording; reads through the file."""
        yield from self._between(topics, None, None)

    def message(self, topic: str, time_ns: int, stamp_ns: int) -> BagMessage:
        """The one message of `topic` that was recorded at `time_ns` and measured at `stamp_ns`."""
        for found in self._between([topic], time_ns, time_ns + 1):
            if found.stamp_ns == stamp_ns:
                return found
        raise InvalidInput(f"{self.path}: expected the message of {topic} that was there when it was opened")

    def _between(self, topics: Collection[str], start: int | None, stop: int | None) -> Iterator[BagMessage]:
        connections = [c for c in self._reader.connections if c.topic in topics]
        if not connections:
            return
        with self._told():
            for connection, time_ns, data in self._reader.messages(connections, start, stop):
                value = self._reader.deserialize(data, connection.msgtype)
                yield BagMessage(connection.topic, time_ns, value)

    @contextmanager
    def _told(self) -> Iterator[None]:
        """Turns what the library says of a broken bag into words about this one."""
        try:
            yield
        except _library_errors() as error:
            raise InvalidInput(f"{self.path}: expected a whole ROS bag, got: {error}") from error


def _library() -> Any:
    try:
        from rosbags import highlevel
    except ImportError as error:
        raise NotConfigured("ROS bags are read by the package rosbags: pip install 'ovip-sg[ros]'") from error
    return highlevel


@cache
def _library_errors() -> tuple[type[Exception], ...]:
    from rosbags.highlevel import AnyReaderError
    from rosbags.rosbag1 import ReaderError as Ros1Error
    from rosbags.rosbag2 import ReaderError as Ros2Error
    from rosbags.serde import SerdeError

    return (AnyReaderError, Ros1Error, Ros2Error, SerdeError, OSError)


def _older_types() -> Any:
    """Message definitions for ROS 2 bags from before they carried their own."""
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_HUMBLE)
