"""What can be wrong with the input, as exceptions whose text is meant for the user."""


class DumpFault(Exception):
    """A file of a dump is missing, damaged or contradicts another one."""

    def __init__(self, path, what):
        super().__init__(f"{path}: {what}")


class NotApplicable(Exception):
    """This error is not defined for this dump; the text says why."""


class UsageFault(Exception):
    """The command line asks for something that does not exist."""
