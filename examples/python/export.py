"""A scene of the benchmark for other programs: ParaView, USD, and a surface with normals.

    pip install '.[export]'
    python examples/python/export.py [SCENE] [FOLDER]     opens in ParaView, Blender, Houdini, usdview
"""
import pathlib
import sys

import pbf


def main(name="dam-break-3d", folder="exported"):
    scene = pbf.load_scene(name)
    fluid = scene.solver()
    out = pathlib.Path(folder)
    out.mkdir(exist_ok=True)
    with pbf.VtkSeries(out / "fluid.pvd") as vtk, pbf.UsdPoints(out / "fluid.usdc", fps=30) as usd:
        for frame in fluid.frames(15, steps=4):
            vtk.add(fluid)
            usd.add(fluid)
    pbf.write_ply(out / "particles.ply", fluid, pressure=fluid.pressures)
    mesh = pbf.surface(fluid)
    mesh.save(out / "surface.ply")
    print(f"{fluid}: {len(mesh.triangles)} triangles; look into {out}/")


if __name__ == "__main__":
    main(*sys.argv[1:])
