"""What blender_test.sh has baked, read by Blender: where a cache puts the vertices in the world must
be where Blender puts those of the OBJ file of the same frame."""

import importlib.util

import bpy

frame = 7  # of the caches, from 0; OBJ files count from 1


def world(thing):
    shown = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return [shown.matrix_world @ vertex.co for vertex in shown.to_mesh().vertices]


def import_obj(path):
    bpy.ops.wm.obj_import(filepath=path)
    return bpy.context.selected_objects[0]


def farthest(a, b):
    assert len(a) == len(b), (len(a), len(b))
    return max((p - q).length for p, q in zip(a, b))


def with_cache(path, kind):
    cape = import_obj("cape_rest.obj")
    modifier = cape.modifiers.new("cache", "MESH_CACHE")
    modifier.cache_format = kind
    modifier.filepath = path
    modifier.frame_start = 0
    bpy.context.scene.frame_set(frame)
    return world(cape)


def cut(path, count):
    """As an interrupted run leaves it: the last `count` bytes are missing."""
    data = open(path, "rb").read()
    name = path.replace(".", ".part.")
    open(name, "wb").write(data[:-count])
    return name


expected = world(import_obj("cape/cape_%04d.obj" % (frame + 1)))
rest = world(import_obj("cape_rest.obj"))
moved = farthest(rest, expected)
assert moved > 0.01, "the cape did not move: this would show nothing"
assert max(p.z for p in expected) > 0.3, "up is z in Blender"

two_frames = 2 * 12 * len(rest)
for kind, name in (("PC2", "cape.pc2"), ("MDD", "cape.mdd")):
    for path in (name, cut(name, two_frames + 5)):
        distance = farthest(with_cache(path, kind), expected)
        print(path, "is", distance, "m from the OBJ file; the frame is", moved, "m from rest")
        assert distance < 1e-5

if importlib.util.find_spec("numpy"):
    import numpy

    numpy.bool = bool  # an alias that Debian's Blender needs and Debian's numpy has no more
    bpy.context.scene.render.fps = 30  # of the cache: glTF has seconds
    bpy.ops.import_scene.gltf(filepath="cape.glb", merge_vertices=False)
    mesh = next(o for o in bpy.context.selected_objects if o.type == "MESH")
    bpy.context.scene.frame_set(frame)
    distance = farthest(world(mesh), expected)
    print("cape.glb is", distance, "m from the OBJ file")
    assert distance < 1e-5
else:
    print("cape.glb is left out: Blender reads glTF with python3-numpy only")

if bpy.app.build_options.usd:
    bpy.ops.wm.usd_import(filepath="cape.usda")
    mesh = next(o for o in bpy.context.selected_objects if o.type == "MESH")
    bpy.context.scene.frame_set(frame)
    distance = farthest(world(mesh), expected)
    print("cape.usda is", distance, "m from the OBJ file")
    assert distance < 1e-5
else:
    print("cape.usda is left out: this Blender is built without USD")
print("what was baked is read")
