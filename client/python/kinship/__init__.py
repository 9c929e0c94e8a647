"""Kinship: an experience database server for robot motion planning.

    import kinship

    robot = kinship.Robot("robots/models/ur10e")
    T_task_base = [0.2, -0.1, 0, 0, 0, 0, 1]       # where it stands in the task's frame
    with kinship.Client() as client:
        client.register(robot)
        distribution = client.fetch("box_to_shelf", robot, T_task_base=T_task_base, deadline=60)
        guidance = client.guidance("box_to_shelf", robot, T_task_base=T_task_base)
    q = distribution.sample(1000, seed=1)          # (1000, dof)
    problem = kinship.Problem("mine", q[0], q[1], T_task_base=T_task_base)
    path = kinship.plan(robot, problem, guidance).waypoints

Configurations are rows: (dof,) is one, (n, dof) are many. Angles are in rad, lengths in m, times in s. Poses come back as
(4, 4) matrices and are taken as these or as x y z qx qy qz qw. What goes wrong is an exception of kinship.errors.
Credentials that end within 30 days are told by `warnings` (CredentialsExpire), and so is
what is not taken as it is given (InputChanged), and solids that cannot be meant (GeometryDoubt).
"""
from .errors import (
    Conflict,
    CredentialsExpire,
    Error,
    FitFailed,
    GeometryDoubt,
    InputChanged,
    InternalError,
    InvalidInput,
    NoExperience,
    NoServer,
    NotFound,
    NotReady,
    Refused,
    StorageError,
    TooLarge,
    UnknownRobot,
)
from ._kinship import (
    Attempt,
    Client,
    Distribution,
    Events,
    Follower,
    Guidance,
    OutboxState,
    Plan,
    PathProof,
    Problem,
    Receipt,
    Registration,
    Robot,
    Sampler,
    Scene,
    World,
    __version__,
    plan,
    read_experience,
    read_problems,
    write_experience,
)

__all__ = [
    "Attempt",
    "Client",
    "Conflict",
    "CredentialsExpire",
    "Distribution",
    "Error",
    "Events",
    "FitFailed",
    "Follower",
    "GeometryDoubt",
    "Guidance",
    "InputChanged",
    "InternalError",
    "InvalidInput",
    "NoExperience",
    "NoServer",
    "NotFound",
    "NotReady",
    "OutboxState",
    "Plan",
    "PathProof",
    "Problem",
    "Receipt",
    "Refused",
    "Registration",
    "Robot",
    "Sampler",
    "Scene",
    "StorageError",
    "TooLarge",
    "UnknownRobot",
    "World",
    "plan",
    "read_experience",
    "read_problems",
    "write_experience",
]
