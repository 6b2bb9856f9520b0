"""What every validation run has in common: frames in, figures and their bars out."""


class Validation:
    name = ""
    title = ""
    definition = ""
    bars = {}  # figure: largest absolute value that passes

    def run(self, dump, frames, options):
        """(figures, rows). Frames come as an iterator: each is read once."""
        raise NotImplementedError
