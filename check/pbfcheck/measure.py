"""What every error has in common."""
from .fault import DumpFault, NotApplicable


class Measure:
    """One error of a run. Made once a dump, fed its frames in order, then finished.

    A constructor or `add` that meets a dump for which the error means nothing raises NotApplicable.
    """

    key = ""
    title = ""
    unit = "1"
    definition = ""

    def __init__(self, dump, options):
        self.dump = dump
        self.options = options

    def add(self, frame):
        """Figures of one frame: a flat dictionary."""
        raise NotImplementedError

    def finish(self, rows):
        """Amends the rows once all are known; returns further entries of the report."""
        return {}

    def need_one_mass(self):
        """Of particles of several fluids a dump does not say which is which."""
        if len(set(self.dump.manifest.phases)) > 1:
            raise NotApplicable("its fluids have several rest densities, and so its particles masses")

    def need_velocities(self, frame):
        if frame.velocities is None:
            raise DumpFault(self.dump.path("velocities", frame.step),
                            f"is missing; {self.key} needs it beside {frame.path}")
        return frame.velocities
