"""Mapped objects in words: a line, a table."""

from __future__ import annotations

from collections.abc import Sequence

from ovip.scene.types import MapObject, Presence


def object_line(o: MapObject) -> str:
    """Id, label, place and size."""
    return f"{o.object_id} {o.label} at {_where(o)} m, {_size(o)} m"


def objects_table(objects: Sequence[MapObject]) -> list[str]:
    """A heading and a line for each object; the last column says what stands out, and how it stands to others."""
    labels = {o.object_id: o.label for o in objects}
    width = max([len(o.label) for o in objects] + [len("label")])
    head = f"{'id':8} {'label':{width}} {'where (m)':>22} {'size (m)':>16} {'frames':>6}  notes"
    return [head] + [
        f"{o.object_id:8} {o.label:{width}} {_where(o):>22} {_size(o):>16} {o.frames:6}  {_notes(o, labels)}".rstrip()
        for o in objects
    ]


def _where(o: MapObject) -> str:
    x, y, z = o.centroid
    return f"({x:.2f}, {y:.2f}, {z:.2f})"


def _size(o: MapObject) -> str:
    x, y, z = o.box[3:] - o.box[:3]
    return f"{x:.2f} x {y:.2f} x {z:.2f}"


def _notes(o: MapObject, labels: dict[str, str]) -> str:
    notes = []
    if o.presence is not Presence.PRESENT:
        notes.append(o.presence.value.replace("_", " "))
    if o.pinned:
        notes.append("pinned")
    if o.label_given:
        notes.append("named by an operator")
    if o.moves:
        notes.append(f"moved {len(o.moves)} times" if len(o.moves) > 1 else "moved once")
    for relation in o.relations:
        other = f"{labels.get(relation.other_id, '')} {relation.other_id}".strip()
        notes.append(f"{relation.kind.value.replace('_', ' ')} {other}")
    return "; ".join(notes)
