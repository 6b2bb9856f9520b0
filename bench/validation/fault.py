"""What went wrong, in words for the user."""


class RunFault(Exception):
    """A program that this command starts did not do its work."""


class UsageFault(Exception):
    """The command line asks for something that does not exist."""
