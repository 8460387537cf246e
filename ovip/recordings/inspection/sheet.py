"""A contact sheet: some frames of a recording, colour above depth, numbered."""

from __future__ import annotations

import cv2
import numpy as np

from ovip.recordings.images import decode_raw_depth
from ovip.recordings.inspection.views import spread
from ovip.recordings.recording import Recording
from ovip.scene.types import U8

FRAMES, COLUMNS, WIDTH, GAP = 12, 4, 240, 6
NEAREST, FARTHEST = 0.3, 6.0
_LINE = 16


def draw_sheet(recording: Recording) -> U8:
    """`(H, W, 3)` blue, green, red: twelve frames spread evenly, each with its index, name and median depth.

    Depth from 0.3 m (red) to 6 m (blue), black where it is missing.
    """
    height = round(WIDTH * recording.intrinsics.height / recording.intrinsics.width)
    tiles = [_tile(recording, at, height) for at in spread(len(recording), FRAMES)]
    blank = np.full_like(tiles[0], 255)
    tiles += [blank] * (-len(tiles) % min(COLUMNS, len(tiles)))
    columns = min(COLUMNS, len(tiles))
    rows = [np.hstack(tiles[start : start + columns]) for start in range(0, len(tiles), columns)]
    return np.asarray(np.vstack(rows), np.uint8)


def _tile(recording: Recording, position: int, height: int) -> U8:
    frame = recording.load(recording.indices[position])
    bgr = cv2.imdecode(np.frombuffer(frame.rgb_bytes, np.uint8), cv2.IMREAD_COLOR)
    raw = decode_raw_depth(frame.depth_bytes)
    tile = np.full((_LINE + 2 * height + 2 * GAP, WIDTH + GAP, 3), 255, np.uint8)
    words = f"{frame.index}  {recording.names()[position]}"
    if bgr is not None:
        tile[_LINE : _LINE + height, :WIDTH] = cv2.resize(bgr, (WIDTH, height), interpolation=cv2.INTER_AREA)
    if raw is not None:
        metres = cv2.resize(raw, (WIDTH, height), interpolation=cv2.INTER_NEAREST) / frame.depth_scale
        tile[_LINE + height + GAP : _LINE + 2 * height + GAP, :WIDTH] = _colored(metres)
        words += f"  {np.median(metres[metres > 0]):.1f} m" if (metres > 0).any() else "  no depth"
    cv2.putText(tile, words, (2, _LINE - 4), cv2.FONT_HERSHEY_SIMPLEX, 0.4, (0, 0, 0), 1, cv2.LINE_AA)
    return tile


def _colored(metres: np.ndarray) -> U8:
    near = np.clip((FARTHEST - metres) / (FARTHEST - NEAREST), 0, 1)
    bgr = cv2.applyColorMap((near * 255).astype(np.uint8), cv2.COLORMAP_TURBO)
    bgr[metres <= 0] = 0
    return np.asarray(bgr, np.uint8)
