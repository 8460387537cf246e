"""Tiny Sweet Home 3D libraries and example homes, in the layout of the real ones."""

from __future__ import annotations

import zipfile
from pathlib import Path

import cv2
import numpy as np

PROPERTIES = """# PluginFurnitureCatalog.properties
id=SweetHome3D#ScopiaModels
license=Creative Commons Attribution 3.0 Unported license  \u00a9 its makers

id#1=Scopia#chair
name#1=Caf\\u00e9 chair
category#1=Living room
model#1=/scopia/chair/chair.obj
width#1=42.0
depth#1=47.4
height#1=88.0
dropOnTopElevation#1=48.2
doorOrWindow#1=false
creator#1=Scopia

id#2=Scopia#tv-remote-control
name#2=TV remote control
model#2=/scopia/tv-remote-control/tv-remote-control.obj
width#2=4.5
depth#2=18
height#2=1.7
creator#2=Somebody
modelRotation#2=1 0 0 0 0 1 0 -1 0

id#3=Scopia#cat
name#3=Cat
model#3=/scopia/cat/cat.obj
width#3=20
depth#3=30
height#3=40
creator#3=Scopia
"""
"""A chair; a remote control that is modelled standing up and laid down by its rotation; a cat, which has no label."""


def box_obj(
    low: tuple[float, float, float], high: tuple[float, float, float], first: int = 1, material: str = ""
) -> str:
    """A box in OBJ, its faces looking outward; `first`: number of its first vertex."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    corners = [(x, y, z) for z in (z0, z1) for y in (y0, y1) for x in (x0, x1)]
    faces = ((1, 3, 4, 2), (5, 6, 8, 7), (1, 2, 6, 5), (3, 7, 8, 4), (1, 5, 7, 3), (2, 4, 8, 6))
    lines = [f"v {x} {y} {z}" for x, y, z in corners]
    lines += [f"usemtl {material}"] if material else []
    lines += ["f " + " ".join(str(first + i - 1) for i in face) for face in faces]
    return "\n".join(lines) + "\n"


def chair_obj() -> str:
    """Seat and back in Sweet Home 3D's frame (y up, front +z), so its back is at -z."""
    seat = box_obj((-1, 0, -1), (1, 1, 1), 1, "seat")
    return "mtllib chair.mtl\n" + seat + box_obj((-1, 1, -1), (1, 2, -0.8), 9, "back")


def write_library(folder: Path) -> Path:
    """`folder/Scopia.sh3f`."""
    path = folder / "Scopia.sh3f"
    large = np.full((300, 600, 3), (200, 30, 10), np.uint8)
    jpeg = cv2.imencode(".jpg", large)[1].tobytes()
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("PluginFurnitureCatalog.properties", PROPERTIES.encode("latin-1"))
        archive.writestr("scopia/chair/chair.obj", chair_obj())
        mtl = "newmtl seat\nKd 1.0 0.5 0.0\nnewmtl back\nKd 1 1 1\nmap_Kd C:\\Users\\a b\\back cloth.jpg\n"
        archive.writestr("scopia/chair/chair.mtl", mtl)
        archive.writestr("scopia/chair/back cloth.jpg", jpeg)
        remote = box_obj((0, 0, 0), (1, 4, 0.2)) + box_obj((0, 3, 0.2), (1, 4, 0.3), 9)
        archive.writestr("scopia/tv-remote-control/tv-remote-control.obj", remote)
        archive.writestr("scopia/cat/cat.obj", box_obj((0, 0, 0), (1, 1, 1)))
    return path


RESOURCES = "com/eteks/sweethome3d/io/resources"
HOME = f"""<?xml version='1.0'?>
<home version='5500' name='Studio.sh3d' wallHeight='250.0'>
  <property name='Author' value='Somebody'/>
  <property name='License' value='CC-BY'/>
  <level id='low' name='Ground' elevation='-100.0' floorThickness='12.0' height='250.0'/>
  <level id='high' name='Roof' elevation='150.0' floorThickness='12.0' height='100.0' visible='false'/>
  <pieceOfFurniture level='low' catalogId='eTeks#squareTable' name='Table' creator='eTeks'
    model='{RESOURCES}/squareTable.obj' x='100' y='50' angle='1.5707964' width='80' depth='40' height='70'>
    <material name='flblonde' color='FF102030'/>
  </pieceOfFurniture>
  <pieceOfFurniture level='low' catalogId='eTeks#plant' name='Plant' creator='eTeks'
    model='{RESOURCES}/plant.obj' x='105' y='60' elevation='70' width='20' depth='20' height='30'/>
  <pieceOfFurniture level='low' catalogId='eTeks#texturableBox' name='Carpet' creator='eTeks'
    model='{RESOURCES}/plant.obj' x='300' y='150' width='100' depth='50' height='1' color='FFFF0000'/>
  <pieceOfFurniture level='low' catalogId='eTeks#texturableBox' name='Box' creator='eTeks'
    model='{RESOURCES}/box.obj' x='300' y='250' width='10' depth='10' height='10'/>
  <pieceOfFurniture level='low' catalogId='eTeks#plant' name='Plant' creator='eTeks' visible='false'
    model='{RESOURCES}/plant.obj' x='105' y='60' width='20' depth='20' height='30'/>
  <pieceOfFurniture level='high' catalogId='eTeks#plant' name='Plant' creator='eTeks'
    model='{RESOURCES}/plant.obj' x='105' y='60' width='20' depth='20' height='30'/>
  <doorOrWindow level='low' catalogId='eTeks#door' name='Door' creator='eTeks'
    model='{RESOURCES}/door.obj' x='200' y='300' width='90' depth='15' height='200'/>
  <furnitureGroup level='low' name='Fireplace' x='350' y='20'>
    <pieceOfFurniture level='low' catalogId='eTeks#texturableBox' name='Box' creator='eTeks'
      model='{RESOURCES}/box.obj' x='350' y='20' width='40' depth='10' height='90'/>
    <pieceOfFurniture level='low' catalogId='eTeks#texturableBox' name='Box' creator='eTeks'
      model='{RESOURCES}/box.obj' x='350' y='20' elevation='90' width='60' depth='20' height='10'/>
  </furnitureGroup>
  <room level='low' name='Kitchen'>
    <point x='0' y='0'/><point x='400' y='0'/><point x='400' y='300'/><point x='0' y='300'/>
  </room>
  <room level='low'>
    <point x='400' y='0'/><point x='500' y='0'/><point x='500' y='300'/><point x='400' y='300'/>
  </room>
  <wall level='low' id='w0' xStart='0' yStart='300' xEnd='400' yEnd='300' height='250' thickness='10'
    leftSideColor='FF0000FF' rightSideColor='FF00FF00'/>
</home>
"""
"""A kitchen of 4 x 3 m whose lower wall has a door, drawn 1 m below ground, and a room without a name."""


def write_example(folder: Path) -> Path:
    """An unpacked example home named Studio; the folder."""
    (folder / "examples").mkdir()
    (folder / "resources").mkdir()
    (folder / "examples" / "Studio.xml").write_text(HOME, encoding="utf-8")
    for name, material in (("squareTable", "flblonde"), ("plant", "yellow_green"), ("box", "white")):
        (folder / "resources" / f"{name}.obj").write_text(box_obj((-1, -1, -1), (1, 1, 1), 1, material))
    return folder
