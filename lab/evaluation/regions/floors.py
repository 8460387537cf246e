"""What a home gives to the regions protocol: evidence and a real map of what a walk saw, and the truth beside them.

A place is made from the same detection cache that every mapper experiment reads; the example homes, whose rooms nobody
here drew, have none and are walked through afresh.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from lab.evaluation.experiment import Options
from lab.evaluation.mapping.making import PlaceSpec, place_of, specs_of
from lab.evaluation.mapping.scoring import mapped
from lab.evaluation.scores.region_matching import NEAR, Room
from lab.simulation.camera import CAMERA
from lab.simulation.home import Area, Home, Storey, inside_polygon
from lab.simulation.imperfect import gated, imperfect_batches, read_cache, rendered_frames
from lab.simulation.small_house import load_small_house
from ovip.errors import InvalidInput
from ovip.scene.types import F64, DetectionBatch, MapObject
from services.mapper.domain.params import MapParams
from services.regions.domain.assembly import PlacedObjects
from services.regions.domain.evidence import FloorEvidence


@dataclass(frozen=True, slots=True)
class Target:
    """A thing to be sought. centre: `(3,)` metres; floor: its storey; function: of the area it is in."""

    label: str
    centre: F64
    floor: int
    function: str


@dataclass(frozen=True, slots=True, eq=False)
class RegionTruth:
    """What is true of a home: storeys, areas, walled rooms, the things in it, and its doors' boxes `(M, 6)`."""

    name: str
    style: str
    storeys: tuple[Storey, ...]
    areas: tuple[Area, ...]
    rooms: tuple[Area, ...]
    targets: tuple[Target, ...]
    doors: F64

    @classmethod
    def of(cls, home: Home) -> RegionTruth:
        """The home's own; every thing that is no structure is a target."""
        functions = {area.area_id: area.function for area in home.areas}
        targets = tuple(
            Target(
                thing.label,
                (thing.box[:3] + thing.box[3:]) / 2,
                thing.floor,
                functions.get(thing.area_id, ""),
            )
            for thing in home.things
        )
        doors = np.array([thing.box for thing in home.objects if thing.label == "door"]).reshape(-1, 6)
        return cls(home.name, home.style, home.storeys, home.areas, home.rooms, targets, doors)

    def storey_at(self, z: float) -> int:
        """The storey whose floor is nearest to a height, as its index."""
        return int(np.argmin([abs(storey.z - z) for storey in self.storeys]))

    def function_at(self, floor: int, xy: F64) -> str:
        """The function of the area at, or else nearest to, a point `(2,)` of a storey; "" where there is none."""
        here = [area for area in self.areas if area.floor == floor]
        if not here:
            return ""
        inside = next((area for area in here if inside_polygon(area.polygon, xy[None])[0]), None)
        return (inside or min(here, key=lambda area: _distance(area.polygon, xy))).function


@dataclass(frozen=True, slots=True, eq=False)
class FloorPlace:
    """A home's truth, what its frames say of the floor, and the objects that the mapper made of its detections."""

    truth: RegionTruth
    evidence: FloorEvidence
    objects: PlacedObjects


def place_specs(options: Options) -> list[PlaceSpec]:
    """The homes that the options ask for. InvalidInput for an unknown data set, or one without true rooms."""
    if options.dataset == "examples":
        from lab.simulation.examples import EXAMPLES

        return [PlaceSpec("examples", options.seed, options.root, name) for name in EXAMPLES]
    if options.dataset not in (None, "small_house"):
        raise InvalidInput(
            f"dataset: expected small_house or examples, or none for simulated homes, got {options.dataset!r}: "
            "regions needs true rooms"
        )
    return specs_of(options)


def floor_place_of(spec: PlaceSpec) -> FloorPlace:
    """The place that a spec names, its detections read from the lab's cache, or made where it keeps none."""
    home = _home_of(spec)
    if spec.dataset != "examples":
        return floor_place(home, read_cache(place_of(spec).cache)[1])
    from lab.simulation.renderer import Renderer
    from lab.simulation.tour import walk_through

    poses = walk_through(home, spec.seed, spec.params.frames)
    frames = rendered_frames(Renderer(home, CAMERA), poses)
    looked = list(imperfect_batches(frames, home.objects, spec.params.imperfect, spec.seed))
    return floor_place(home, gated(lambda: looked))


def floor_place(home: Home, batches: Iterable[DetectionBatch], params: MapParams | None = None) -> FloorPlace:
    """Runs all batches through the mapper, and their surfaces into floor evidence."""
    evidence = FloorEvidence()
    scene = mapped(_noting(batches, evidence), params or MapParams())
    return FloorPlace(RegionTruth.of(home), evidence, placed(scene.objects))


def placed(objects: Sequence[MapObject]) -> PlacedObjects:
    """The map's objects by id, as the regions service reads them."""
    by_id = sorted(objects, key=lambda o: o.object_id)
    return PlacedObjects(
        ids=tuple(o.object_id for o in by_id),
        labels=tuple(o.label for o in by_id),
        centres=np.array([o.centroid for o in by_id], dtype=np.float64).reshape(-1, 3),
    )


def rooms_of(areas: Iterable[Area]) -> list[Room]:
    """The areas as clouds of cells of the world's 0.05 m lattice; an area that holds no cell is left out."""
    rooms = [Room(area.floor, _cells_in(area.polygon)) for area in areas]
    return [room for room in rooms if len(room.points)]


def _noting(batches: Iterable[DetectionBatch], evidence: FloorEvidence) -> Iterator[DetectionBatch]:
    """The batches, each frame's surface added to the evidence as it goes by."""
    for batch in batches:
        if not batch.late:
            evidence.add(batch.frame_id, batch.surface, batch.world_from_camera[:3, 3])
        yield batch


def _home_of(spec: PlaceSpec) -> Home:
    if spec.dataset == "examples":
        from lab.simulation.examples import load_example

        return load_example(spec.scene, spec.root)
    if spec.dataset == "small_house":
        assert spec.root is not None
        return load_small_house(spec.root)
    from lab.simulation.generate import make_home

    return make_home(spec.seed, spec.style)


def _cells_in(polygon: F64) -> F64:
    """Centres of the lattice's cells that lie in an open ring `(M, 2)` -> `(N, 2)`."""
    low, high = np.floor(polygon.min(axis=0) / NEAR), np.ceil(polygon.max(axis=0) / NEAR)
    x, y = (np.arange(a, b) * NEAR + NEAR / 2 for a, b in zip(low, high, strict=True))
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    return points[inside_polygon(polygon, points)]


def _distance(polygon: F64, xy: F64) -> float:
    """Metres from a point `(2,)` to an open ring `(M, 2)`."""
    start, way = polygon, np.roll(polygon, -1, axis=0) - polygon
    along = ((xy - start) * way).sum(axis=1) / np.maximum((way**2).sum(axis=1), 1e-12)
    nearest = start + np.clip(along, 0.0, 1.0)[:, None] * way
    return float(np.linalg.norm(nearest - xy, axis=1).min())
