"""Sweet Home 3D furniture libraries (`*.sh3f`): their catalogue, and their models turned into our frame."""

from __future__ import annotations

import hashlib
import re
import zipfile
from collections.abc import Collection
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from lab.simulation.catalogue.config import cache_folder
from lab.simulation.catalogue.dressing import main_materials
from lab.simulation.catalogue.mesh_cache import MeshCache
from lab.simulation.catalogue.model import Shelf, Size, Undressed, Variant, fitted
from lab.simulation.catalogue.models import LABEL_OF, Mapped
from lab.simulation.catalogue.simplifying import simplified
from lab.simulation.catalogue.wavefront import read_wavefront
from lab.simulation.catalogue.words import ATTRIBUTES, elevation_of
from lab.simulation.home import Mesh
from ovip.scene.types import F64

FURNITURE = Path("/usr/share/sweethome3d/furniture")
"""Where Debian's sweethome3d-furniture puts its libraries."""
PREPARATION = 1
"""Part of every cache key; counted up when meshes come out otherwise than before."""
BUDGETS = ((0.35, 2000), (1.0, 4000), (np.inf, 6000))
"""Longest side in metres up to which a model may have so many triangles."""

_LICENSES = (("public domain", "CC0"), ("united states", "CC-BY 3.0 US"), ("attribution 3.0", "CC-BY 3.0"))


@dataclass(frozen=True, slots=True)
class Entry:
    """One piece of a library. size: metres, ours. rotation: `(9,)` row-major, applied before sizing; None = none.

    elevation, top: metres; top None = carries nothing. model: its path in the archive.
    """

    archive: Path
    model: str
    name: str
    creator: str
    license: str
    size: Size
    top: float | None
    elevation: float
    rotation: tuple[float, ...] | None

    @property
    def key(self) -> str:
        """What the mapping to labels knows it by: library and model."""
        return f"{self.archive.stem}/{Path(self.model).stem}"

    @property
    def attribution(self) -> str:
        """Who made it, under which licence."""
        return f"{self.name} by {self.creator}, {self.license} (Sweet Home 3D furniture library)"


def library_entries(archive: Path) -> tuple[Entry, ...]:
    """Everything that a `.sh3f` file offers, in its order."""
    with zipfile.ZipFile(archive) as held:
        values = properties(held.read("PluginFurnitureCatalog.properties").decode("latin-1"))
    license_ = _short_license(values.get("license", ""))
    numbers = sorted(int(key.partition("#")[2]) for key in values if key.startswith("model#"))
    return tuple(_entry(archive, values, number, license_) for number in numbers)


def properties(text: str) -> dict[str, str]:
    """A Java properties file: `key = value` lines, `#` and `!` comments, `\\uXXXX` escapes."""
    values: dict[str, str] = {}
    for line in re.sub(r"\\\r?\n\s*", "", text).split("\n"):
        if line.strip() and line.lstrip()[0] not in "#!":
            key, value = (*re.split(r"\s*[=:]\s*", line.strip(), maxsplit=1), "")[:2]
            values[key] = re.sub(r"\\u([0-9a-fA-F]{4})", lambda m: chr(int(m[1], 16)), value).strip()
    return values


class SweetHomeShelf:
    """The mapped models of all libraries in a folder as a shelf of a catalogue.

    carriers: the labels whose models carry things; a mug has a top, but nothing stands on it.
    """

    def __init__(self, folder: Path, carriers: Collection[str], cache: MeshCache) -> None:
        self._cache = cache
        found = [e for archive in sorted(folder.glob("*.sh3f")) for e in library_entries(archive)]
        self._entries = {entry.key: entry for entry in found if entry.key in LABEL_OF}
        self.variants: tuple[Variant, ...] = tuple(
            _variant(entry, LABEL_OF[key], LABEL_OF[key].label in carriers)
            for key, entry in self._entries.items()
        )

    def make(self, variant: Variant, size: Size) -> Undressed:
        """The model stretched to measure `size`."""
        entry = self._entries[variant.name]
        mesh = fitted(_turned(entry_mesh(entry, self._cache), LABEL_OF[entry.key].turn), size)
        return Undressed(mesh, main_materials(mesh), entry.attribution)


def sweet_home_shelf(folder: Path, carriers: Collection[str]) -> Shelf:
    """The libraries in a folder; nothing is on the shelf where it has none."""
    return SweetHomeShelf(folder, carriers, MeshCache(cache_folder() / "models"))


def entry_mesh(entry: Entry, cache: MeshCache) -> Mesh:
    """A piece's mesh: in our frame, at its size, within its budget of triangles."""
    with zipfile.ZipFile(entry.archive) as archive:
        return cache.get(_content_key(entry, archive), lambda: _prepared(entry, archive))


def upright(mesh: Mesh, rotation: tuple[float, ...] | None) -> Mesh:
    """A Sweet Home model (y up, front +z) in our frame (z up, front -y), its own rotation applied first."""
    own = np.eye(3) if rotation is None else np.asarray(rotation, np.float64).reshape(3, 3)
    return rotated(mesh, np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]) @ own)


def rotated(mesh: Mesh, turn: F64) -> Mesh:
    """The mesh turned by a rotation `(3, 3)` about the origin."""
    return replace(
        mesh,
        vertices=(mesh.vertices @ turn.T).astype(np.float32),
        normals=(mesh.normals @ turn.T).astype(np.float32),
    )


def triangle_budget(size: Size) -> int:
    """How many triangles a thing of this size may have."""
    return next(budget for side, budget in BUDGETS if max(size) <= side)


def _prepared(entry: Entry, archive: zipfile.ZipFile) -> Mesh:
    names = {name.lower(): name for name in archive.namelist()}
    folder = entry.model.rpartition("/")[0]

    def beside(name: str) -> bytes | None:
        found = names.get(f"{folder}/{name}".lower())
        return archive.read(found) if found else None

    mesh = read_wavefront(archive.read(entry.model).decode("latin-1"), beside)
    mesh = simplified(fitted(upright(mesh, entry.rotation), entry.size), triangle_budget(entry.size))
    return fitted(mesh, entry.size)


def _content_key(entry: Entry, archive: zipfile.ZipFile) -> str:
    """A hash of the model's own files and of what is done with them."""
    folder = entry.model.rpartition("/")[0] + "/"
    files = sorted(
        (i.filename, i.CRC, i.file_size) for i in archive.infolist() if i.filename.startswith(folder)
    )
    content = repr((PREPARATION, entry.model, entry.size, entry.rotation, BUDGETS, files))
    return hashlib.sha256(content.encode()).hexdigest()[:32]


def _entry(archive: Path, values: dict[str, str], number: int, license_: str) -> Entry:
    def metres(key: str) -> float:
        return float(values.get(f"{key}#{number}", "0")) / 100

    top = metres("dropOnTopElevation") if f"dropOnTopElevation#{number}" in values else None
    size = (metres("width"), metres("depth"), metres("height"))
    rotation = values.get(f"modelRotation#{number}")
    return Entry(
        archive=archive,
        model=values[f"model#{number}"].lstrip("/"),
        name=values.get(f"name#{number}", "").strip(),
        creator=values.get(f"creator#{number}", "unknown"),
        license=license_,
        size=size,
        top=size[2] if top is None else top if top > 0 else None,
        elevation=metres("elevation"),
        rotation=tuple(float(v) for v in rotation.split()) if rotation else None,
    )


def _short_license(text: str) -> str:
    return next((short for words, short in _LICENSES if words in text.lower()), text.split("\n")[0].strip())


def _variant(entry: Entry, mapped: Mapped, carries: bool) -> Variant:
    width, depth, height = (side * mapped.scale for side in entry.size)
    own = None if entry.top is None else entry.top * mapped.scale
    usual = elevation_of(mapped.label)
    return Variant(
        label=mapped.label,
        name=entry.key,
        size=(depth, width, height) if mapped.turn % 180 else (width, depth, height),
        top=(own if mapped.top is None else mapped.top or None) if carries else None,
        attributes=() if mapped.one_look else ATTRIBUTES.get(mapped.label, ()),
        elevation=0.0 if mapped.stands or not usual else entry.elevation or usual,
    )


def _turned(mesh: Mesh, degrees: float) -> Mesh:
    """Turned about z, counter-clockwise seen from above."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return rotated(mesh, np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]]))
