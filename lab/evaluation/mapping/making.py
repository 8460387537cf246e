"""Makes a place once and keeps it: frames rendered, detections drawn, truth sampled, under a hash of what made it."""

from __future__ import annotations

import hashlib
import shutil
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

import lab.simulation
import services.perception.domain
from lab.evaluation.experiment import Options
from lab.evaluation.mapping.places import Place, Storey, load_place, save_place
from lab.evaluation.mapping.replica import replica_scenes, replica_source
from lab.evaluation.mapping.sources import Source, simulated_source, small_house_source
from lab.evaluation.mapping.survey import Survey, SurveyParams
from lab.simulation.catalogue.config import cache_folder
from lab.simulation.home import Home, HomeObject
from lab.simulation.imperfect import (
    NOISY,
    FeatureModel,
    ImperfectParams,
    gated,
    header_for,
    imperfect_batches,
    write_cache,
)
from lab.simulation.world import HOME_CAMERA
from ovip.errors import InvalidInput
from ovip.scene.types import F32, I64, Intrinsics

_CACHE = "detections.cache"


@dataclass(frozen=True, slots=True)
class PlaceParams:
    """imperfect: what perception makes of the frames. dimension: of its features. frames, camera: of a simulated walk.

    seen_within: metres from the reconstruction beyond which truth was not seen by the walk, and does not count.
    """

    imperfect: ImperfectParams = NOISY
    dimension: int = 512
    frames: int = 400
    camera: Intrinsics = HOME_CAMERA
    seen_within: float = 0.03
    survey: SurveyParams = field(default_factory=SurveyParams)


@dataclass(frozen=True, slots=True)
class PlaceSpec:
    """Names a place. dataset: None = a simulated home of `seed` and `style` (None: by the seed); else as in Options.

    scene: folder name of a data set that has several.
    """

    dataset: str | None = None
    seed: int = 0
    root: Path | None = None
    scene: str = ""
    style: str | None = None
    params: PlaceParams = field(default_factory=PlaceParams)


def specs_of(options: Options) -> list[PlaceSpec]:
    """The places that the options ask for; InvalidInput for a data set that is unknown or not there."""
    if options.dataset is None:
        return [PlaceSpec(seed=options.seed + i) for i in range(options.homes)]
    if options.dataset not in ("small_house", "replica"):
        raise InvalidInput(
            f"dataset: expected small_house or replica, or none for simulated homes, got {options.dataset!r}"
        )
    if options.root is None or not options.root.is_dir():
        raise InvalidInput(f"root: expected the folder of {options.dataset}, got {options.root}")
    if options.dataset == "small_house":
        return [PlaceSpec("small_house", options.seed, options.root)]
    return [PlaceSpec("replica", options.seed, options.root, scene) for scene in replica_scenes(options.root)]


def place_of(spec: PlaceSpec, folder: Path | None = None) -> Place:
    """The place, made and kept in `folder` (None: the lab's cache) where it was not there yet."""
    home = (folder or cache_folder() / "places") / _name_of(spec)
    found = load_place(home)
    if found:
        return found
    home.parent.mkdir(parents=True, exist_ok=True)
    making = Path(tempfile.mkdtemp(dir=home.parent, prefix=f".{home.name}-"))
    try:
        save_place(making, make_place(_source(spec), spec.params, spec.seed, making))
        if not home.exists():  # another process may have been faster
            making.rename(home)
    finally:
        shutil.rmtree(making, ignore_errors=True)
    made = load_place(home)
    assert made is not None
    return made


def make_place(source: Source, params: PlaceParams, seed: int, folder: Path) -> Place:
    """Goes through the frames once: detections into a cache in `folder`, the reconstruction, and what was seen."""
    home, survey = source.home, Survey(params.survey)
    classes = source.classes or tuple(sorted({thing.label for thing in home.objects}))
    model = FeatureModel(classes, params.dimension)
    looked = list(
        imperfect_batches(map(survey.add, source.frames), home.objects, params.imperfect, seed, model)
    )
    batches = list(gated(lambda: looked))
    write_cache(folder / _CACHE, header_for(home.name, seed, params.imperfect, model, len(batches)), batches)
    labels = [d.label for batch in batches for d in batch.detections]
    words = (*classes, *sorted(set(labels) - set(classes)))
    dense = survey.dense
    points, ids = source.points, source.ids
    if source.only_seen:
        points, ids = _seen(points, ids, dense, params.seen_within)
    class_of = _class_of(home, classes)
    counted = _counted(home, ids, survey.seen_ids)
    native = np.isin(ids, [thing.object_id for thing in counted])
    return Place(
        name=home.name,
        words=words,
        word_features=model.text(words),
        classes=len(classes),
        structural=frozenset(thing.label for thing in home.objects if thing.structural),
        dense=dense,
        dense_class=class_of[ids[cKDTree(points).query(dense)[1]]],
        points=points[native],
        instances=ids[native],
        point_class=class_of[ids[native]],
        area_ids=np.array([thing.object_id for thing in counted], np.int64),
        areas=np.array([thing.surface_area for thing in counted]),
        sizes=np.array([float((thing.box[3:] - thing.box[:3]).max()) for thing in counted]),
        frames=survey.frames,
        detections=len(labels),
        features=model.space,
        storeys=_storeys(home),
        cache=folder / _CACHE,
    )


def _source(spec: PlaceSpec) -> Source:
    if spec.dataset is None:
        return simulated_source(spec.seed, spec.style, spec.params.frames, spec.params.camera)
    assert spec.root is not None
    if spec.dataset == "small_house":
        return small_house_source(spec.root)
    return replica_source(spec.root, spec.scene)


def _seen(points: F32, ids: I64, dense: F32, within: float) -> tuple[F32, I64]:
    """Truth that lies within reach of the reconstruction, and is of some object."""
    distance, _ = cKDTree(dense).query(points, distance_upper_bound=within)
    keep = np.isfinite(distance) & (ids > 0)
    return points[keep], ids[keep]


def _class_of(home: Home, classes: Sequence[str]) -> I64:
    """The class of each object id `(max id + 1,)`; a label that is no class is the first, "other"."""
    table = np.zeros(1 + max(thing.object_id for thing in home.objects), np.int64)
    for thing in home.objects:
        table[thing.object_id] = classes.index(thing.label) if thing.label in classes else 0
    return table


def _counted(home: Home, ids: I64, seen: I64) -> list[HomeObject]:
    """The instances that count: things that the walk saw, with a point of truth."""
    here = set(np.unique(ids).tolist()) & set(seen.tolist())
    return [thing for thing in home.things if thing.object_id in here]


def _storeys(home: Home) -> tuple[Storey, ...]:
    return tuple(
        Storey(
            f"floor {storey.floor}",
            storey.z,
            storey.ceiling_z,
            tuple(
                (area.name, tuple((float(x), float(y)) for x, y in area.polygon))
                for area in home.areas
                if area.floor == storey.floor
            ),
        )
        for storey in home.storeys
    )


def _name_of(spec: PlaceSpec) -> str:
    """A folder name that says which place, and changes with anything that it is made by."""
    digest = hashlib.sha256(repr(spec).encode())
    for made_by in (lab.simulation, services.perception.domain):
        for path in sorted(Path(made_by.__file__ or "").parent.rglob("*.py")):
            digest.update(path.read_bytes())
    for path in sorted(Path(__file__).parent.glob("places*.py")):
        digest.update(path.read_bytes())
    if spec.root is not None:
        for path in sorted(spec.root.rglob("*")):
            digest.update(f"{path.relative_to(spec.root)} {path.stat().st_size}".encode())
    label = spec.dataset or "home"
    return f"{label}-{spec.scene or spec.seed}-{digest.hexdigest()[:16]}"
