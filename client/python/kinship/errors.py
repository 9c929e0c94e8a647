"""What can go wrong, as exceptions. The text names the thing, its value and the limit."""


class Error(Exception):
    """The base of all of them."""


class InvalidInput(Error, ValueError):
    """A value breaks a rule: a number of joints, a pose that is none, a field of a file."""


class TooLarge(Error, ValueError):
    """A size limit is exceeded."""


class NotFound(Error, LookupError):
    """A file, link, robot or task that is named does not exist."""


class UnknownRobot(NotFound):
    """The server does not know the robot: register it."""


class NoExperience(NotFound):
    """Nobody has reported a path of the task that could be used."""


class Conflict(Error):
    """A label is another robot's, or a report's UUID was used for something else."""


class Refused(Error):
    """The server refuses a robot, a report or a request."""


class NoServer(Error, ConnectionError):
    """No server answered in time."""


class NotReady(Error, TimeoutError):
    """The deadline has passed while the server was still making the distribution, or was busy."""


class FitFailed(Error):
    """There is experience, but nothing of it could be transferred or fitted."""


class StorageError(Error, OSError):
    """A file or folder cannot be read or written."""


class InternalError(Error, RuntimeError):
    """A bug of Kinship, or an unexpected answer of a library."""


class InputChanged(UserWarning):
    """Told by `warnings` when not all that was given is taken as it is: pairs of an SRDF with links that the robot does not have, a start or goal moved onto a joint's limit."""


class GeometryDoubt(UserWarning):
    """Told by `warnings` of what was planned with and cannot be meant: links without solids, sizes in mm, obstacles that the robot never reaches or that lie within a mesh."""


class CredentialsExpire(UserWarning):
    """Told by `warnings` when a Client is opened: its credentials are valid for less than 30 days."""
