"""An operator's edits."""

from __future__ import annotations

from typing import Any

from ovip.codec.geometry import box_message, box_value
from ovip.codec.reading import parsed
from ovip.errors import Corrupt, InvalidInput
from ovip.scene.edits import Delete, Edit, EditRequest, Merge, Pin, Rename, Split
from ovip.v1 import mapper_pb2


def edit_request_message(request: EditRequest, scene: str = "") -> mapper_pb2.EditMapRequest:
    return mapper_pb2.EditMapRequest(
        scene=scene,
        edit_id=request.edit_id,
        made_on_version=request.made_on_version,
        operator=request.operator,
        **_edit_field(request.edit),
    )


def edit_request_value(m: mapper_pb2.EditMapRequest) -> EditRequest:
    """InvalidInput where the message holds no edit; whether the map allows it, the map says."""
    return EditRequest(m.edit_id, m.made_on_version, m.operator, _edit_value(m))


def encode_edit_request(request: EditRequest) -> bytes:
    """The bytes of a request, the same for the same request."""
    return edit_request_message(request).SerializeToString(deterministic=True)


def decode_edit_request(data: bytes) -> EditRequest:
    """Corrupt where the bytes are no edit request."""
    message = parsed(mapper_pb2.EditMapRequest, data)
    try:
        return edit_request_value(message)
    except InvalidInput as error:
        raise Corrupt(f"EditMapRequest: {error}") from error


def _edit_field(edit: Edit) -> dict[str, Any]:
    match edit:
        case Rename():
            return {"rename": mapper_pb2.RenameEdit(object_id=edit.object_id, label=edit.label)}
        case Merge():
            return {"merge": mapper_pb2.MergeEdit(keep_id=edit.keep_id, merged_ids=edit.merged_ids)}
        case Split():
            part, label = box_message(edit.part), edit.part_label
            return {"split": mapper_pb2.SplitEdit(object_id=edit.object_id, part=part, part_label=label)}
        case Delete():
            return {"delete": mapper_pb2.DeleteEdit(object_id=edit.object_id)}
        case Pin():
            return {"pin": mapper_pb2.PinEdit(object_id=edit.object_id, pinned=edit.pinned)}


def _edit_value(m: mapper_pb2.EditMapRequest) -> Edit:
    match m.WhichOneof("edit"):
        case "rename":
            return Rename(m.rename.object_id, m.rename.label)
        case "merge":
            return Merge(m.merge.keep_id, tuple(m.merge.merged_ids))
        case "split":
            if not m.split.HasField("part"):
                raise InvalidInput("split: expected the box of the part")
            return Split(m.split.object_id, box_value(m.split.part), m.split.part_label)
        case "delete":
            return Delete(m.delete.object_id)
        case "pin":
            return Pin(m.pin.object_id, m.pin.pinned)
        case _:
            raise InvalidInput("edit: expected one of rename, merge, split, delete, pin")
