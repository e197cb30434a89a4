"""What goes wrong. Each message names the file, says what is wrong with it, and what to do."""


class DatasetError(Exception):
    """A dataset that cannot be read, or is not what was asked for."""


class SpecError(ValueError):
    """A spec that no network can have."""


class ModelError(Exception):
    """A model folder that cannot be read or written."""
