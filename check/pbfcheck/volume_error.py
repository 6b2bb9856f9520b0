"""E2: volume."""
from .fault import NotApplicable
from .measure import Measure
from .spray import is_spray
from .volume import splat_volume


class VolumeError(Measure):
    key = "E2"
    title = "volume"
    definition = (
        "V(t)/V(0) - 1, signed. V: region where a splat of the particles (Wendland C2 of 2 rest "
        "spacings, mirrored in the walls) exceeds half the rest density, plus the rest volume of "
        "every spray particle (groups of fewer than 3^dim). V(0) is that of the first frame of the "
        "dump. `against_rest`: the same against N rest volumes. `splat_only`: without the spray.")

    def __init__(self, dump, options):
        super().__init__(dump, options)
        self.first = None

    def add(self, frame):
        dump = self.dump
        if not len(frame.positions):
            raise NotApplicable(f"step {frame.step} has no particles")
        spray = is_spray(frame.positions, dump.rest_spacing)
        surfaces = dump.manifest.walls.surfaces(frame.time)
        bulk = splat_volume(frame.positions[~spray], dump.rest_spacing, surfaces) if not spray.all() else 0.0
        volume = bulk + int(spray.sum()) * dump.rest_volume
        if self.first is None:
            self.first = (volume, bulk)
        return {"relative": volume / self.first[0] - 1,
                "against_rest": volume / (len(frame.positions) * dump.rest_volume) - 1,
                "splat_only": bulk / self.first[1] - 1 if self.first[1] > 0 else None,
                "volume": volume, "spray_particles": int(spray.sum())}
