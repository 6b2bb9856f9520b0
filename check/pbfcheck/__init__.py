"""External checker of simulation errors. Shares no code with any solver: its only input is files."""

FORMAT_VERSION = 1  # of the JSON report
