"""Write random worlds as Mitsuba 3 scenes, to try advice on scenes that nobody tuned.

usage: python3 tests/peers/random_worlds.py FOLDER COUNT [FIRST]

World number N, FOLDER/N.xml, is drawn by the seed N alone: objects on a floor, materials, textures, lights and a camera.
"""

import math
import random
import sys
from pathlib import Path


def between(draw, low, high):
    """Draw a number whose logarithm is uniform."""
    return math.exp(draw.uniform(math.log(low), math.log(high)))


def colour(draw):
    return f'<spectrum name="reflectance" value="{draw.uniform(0.1, 0.9):.3f}"/>'


def texture(draw):
    if draw.random() < 0.6:
        return colour(draw)
    cells = between(draw, 2, 30)
    dark, light = draw.uniform(0.05, 0.4), draw.uniform(0.4, 0.95)
    return f"""<texture name="reflectance" type="checkerboard"><spectrum name="color0" value="{dark:.3f}"/><spectrum name="color1" value="{light:.3f}"/>
  <transform name="to_uv"><scale x="{cells:.2f}" y="{cells:.2f}"/></transform></texture>"""


def material(draw):
    kind = draw.choice(["diffuse", "metal", "metal", "plastic"])
    if kind == "diffuse":
        return f'<bsdf type="twosided"><bsdf type="diffuse">{texture(draw)}</bsdf></bsdf>'
    alpha = between(draw, 0.02, 0.5)
    if kind == "metal":
        return f'<bsdf type="roughconductor"><float name="alpha" value="{alpha:.4f}"/><string name="distribution" value="ggx"/><string name="material" value="none"/></bsdf>'
    base = colour(draw).replace("reflectance", "diffuse_reflectance")
    return f'<bsdf type="roughplastic"><float name="alpha" value="{alpha:.4f}"/><string name="distribution" value="ggx"/>{base}</bsdf>'


def placed(draw, side):
    """The transform of an object of half-width 1 that stands on the floor, and its size."""
    size = between(draw, 0.15, 0.6)
    x, z = draw.uniform(-side, side), draw.uniform(-side, side)
    return size, f'<rotate y="1" angle="{draw.uniform(0, 360):.1f}"/><translate x="{x:.3f}" y="{size:.3f}" z="{z:.3f}"/>'


def shape(draw):
    kind = draw.choice(["sphere", "sphere", "cube", "cylinder"])
    size, move = placed(draw, 1.5)
    if kind == "cylinder":
        ends = f'<point name="p0" x="0" y="{-size:.3f}" z="0"/><point name="p1" x="0" y="{size:.3f}" z="0"/><float name="radius" value="{0.6 * size:.3f}"/>'
        return f'<shape type="cylinder">{ends}<transform name="to_world">{move}</transform>{material(draw)}</shape>'
    scale = f'<scale value="{size:.3f}"/>'
    return f'<shape type="{kind}"><transform name="to_world">{scale}{move}</transform>{material(draw)}</shape>'


def light(draw):
    kind = draw.choice(["sphere", "rectangle", "sky"])
    if kind == "sky":
        return f'<emitter type="constant"><spectrum name="radiance" value="{draw.uniform(0.2, 1):.3f}"/></emitter>'
    x, y, z = draw.uniform(-2, 2), draw.uniform(1.5, 3), draw.uniform(-2, 2)
    size = between(draw, 0.05, 0.6)
    radiance = draw.uniform(1, 4) / size**2
    emitter = f'<emitter type="area"><spectrum name="radiance" value="{radiance:.3f}"/></emitter>'
    if kind == "sphere":
        return f'<shape type="sphere"><point name="center" x="{x:.3f}" y="{y:.3f}" z="{z:.3f}"/><float name="radius" value="{size:.3f}"/>{emitter}</shape>'
    look = f'<scale value="{size:.3f}"/><lookat origin="{x:.3f},{y:.3f},{z:.3f}" target="0,0,0" up="0.1,0,1"/>'
    return f'<shape type="rectangle"><transform name="to_world">{look}</transform>{emitter}</shape>'


def world(number):
    draw = random.Random(number)
    turn, height, distance = draw.uniform(0, 2 * math.pi), draw.uniform(0.8, 3), draw.uniform(4, 6)
    eye = f"{distance * math.cos(turn):.3f},{height:.3f},{distance * math.sin(turn):.3f}"
    floor = '<scale value="5"/><rotate x="1" angle="-90"/>'
    lights = [light(draw)]
    while len(lights) < draw.choice([1, 2, 3]) and not any("constant" in one for one in lights):
        lights.append(light(draw))
    parts = [
        f'<shape type="rectangle"><transform name="to_world">{floor}</transform>{material(draw)}</shape>',
        *(shape(draw) for _ in range(draw.randint(3, 8))),
        *lights,
    ]
    return f"""<scene version="3.0.0">
<integrator type="path"><integer name="max_depth" value="3"/></integrator>
<sensor type="perspective"><float name="fov" value="{draw.uniform(30, 50):.2f}"/>
  <transform name="to_world"><lookat origin="{eye}" target="0,0.3,0" up="0,1,0"/></transform>
  <film type="hdrfilm"><integer name="width" value="300"/><integer name="height" value="190"/><rfilter type="box"/></film>
</sensor>
{chr(10).join(parts)}
</scene>
"""


def main():
    folder, count, first = Path(sys.argv[1]), int(sys.argv[2]), int((sys.argv + ["1"])[3])
    folder.mkdir(parents=True, exist_ok=True)
    for number in range(first, first + count):
        (folder / f"{number}.xml").write_text(world(number))


if __name__ == "__main__":
    main()
