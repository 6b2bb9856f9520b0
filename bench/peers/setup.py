"""What SPlisHSPlasH reads: its scene, its particles, the mesh of its walls. Text only, so that it can be
tested without the solver."""

METHODS = {"pbf": 2, "dfsph": 4}  # its enum simulationMethod
AKINCI_2012 = 0  # its enum boundaryHandlingMethod: walls of particles
REGULAR_TRIANGLES = 1  # its enum samplingMode

CORNERS = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
# Two triangles a side of the unit cube, counted from 1, seen counter-clockwise from outside.
TRIANGLES = [(1, 3, 2), (2, 3, 4), (5, 6, 7), (6, 8, 7), (1, 2, 5), (2, 6, 5),
             (3, 7, 4), (4, 7, 8), (1, 5, 3), (3, 5, 7), (2, 4, 6), (4, 8, 6)]


def unit_cube():
    """A Wavefront mesh."""
    lines = ["v %d %d %d" % corner for corner in CORNERS]
    lines += ["f %d %d %d" % triangle for triangle in TRIANGLES]
    return "\n".join(lines) + "\n"


def particle_file(positions):
    """Partio's ASCII format; velocities in it are not read."""
    head = ["ATTRIBUTES", " position velocity", "TYPES", " V V",
            f"NUMBER_OF_PARTICLES: {len(positions)}", "BEGIN DATA"]
    rows = [" ".join(f"{float(c):.9g}" for c in row) + " 0 0 0" for row in positions]
    return "\n".join(head + rows) + "\n"


def wall_planes(low, high, spacing):
    """(min, max) of the planes of its wall particles, for a fluid whose first layer may lie half a spacing
    from `low` and `high`.

    At one spacing from its wall particles a lattice is compressed, and is thrown off them; at 1.25 it is not, and
    comes to rest at about 0.9.
    """
    behind = 0.75 * spacing
    return [c - behind for c in low], [c + behind for c in high]


def wall_surfaces(planes, spacing):
    """Where the judge has its wall begin: half a spacing before the particles."""
    low, high = planes
    return [c + spacing / 2 for c in low], [c - spacing / 2 for c in high]


def wall(folder, planes):
    low, high = planes
    return {"geometryFile": f"{folder}/cube.obj", "translation": list(low),
            "scale": [b - a for a, b in zip(low, high)], "rotationAxis": [1, 0, 0], "rotationAngle": 0,
            "isDynamic": False, "isWall": True, "mapInvert": True, "samplingMode": REGULAR_TRIANGLES}


def scene(folder, job):
    """Its scene file: everything that `job` does not name is its default."""
    first = job["segments"][0]
    configuration = {
        "simulationMethod": METHODS[job["method"]], "particleRadius": job["spacing"] / 2,
        "timeStepSize": first["time_steps"][0], "cflMethod": 0, "gravitation": list(first["gravity"]),
        "boundaryHandlingMethod": AKINCI_2012, "stopAt": 1e9}
    document = {"Configuration": configuration,
                "FluidModels": [{"id": "Fluid", "particleFile": f"{folder}/start.pda",
                                 "translation": [0, 0, 0], "scale": [1, 1, 1]}],
                "Materials": [{"id": "Fluid", "density0": 1000}]}
    if job.get("planes"):
        document["RigidBodies"] = [wall(folder, job["planes"])]
    return document


def manifest(job):
    """dump.json for pbf-check: its kernel, its h, its particle volume, and the surfaces of its walls."""
    spacing, first = job["spacing"], job["segments"][0]
    low, high = job["surfaces"] or ([None] * 3, [None] * 3)
    return {"dimension": 3, "smoothing_radius": 2 * spacing, "spacing": spacing,
            "particle_volume": spacing ** 3, "kernel": "cubic_spline", "gravity": list(first["gravity"]),
            "domain_min": list(low), "domain_max": list(high), "walls": {"offset": 0},
            "time_step": first["time_steps"][0]}
