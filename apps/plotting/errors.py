"""What a user's bad input raises."""


class BadInput(Exception):
    """A file or folder that cannot be used: the message names the file and the column or dataset, in one line."""


class NotInThisRun(Exception):
    """The run is sound but holds nothing for this figure (a REV alone has no mesh, for instance)."""
