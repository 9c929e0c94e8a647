#!/usr/bin/python3
"""02 from another language: the C library called by whatever can call C, here by Python's ctypes.

    02_fetch_and_sample_ctypes.py LIBKINSHIP MODELS
"""
import ctypes
import sys
from ctypes import POINTER, byref, c_char_p, c_double, c_int, c_size_t, c_uint32, c_uint64, c_void_p


class Structure(ctypes.Structure):
    """Begins with its size; all else that is 0 is as if it were not said."""
    def __init__(self, **members):
        super().__init__(size=ctypes.sizeof(self), **members)


class RobotFile(Structure):
    _fields_ = [("size", c_size_t), ("source", c_char_p), ("base_link", c_char_p), ("tip_link", c_char_p),
                ("label", c_char_p), ("T_tip_transfer", POINTER(c_double))]  # the others are not needed here


class Request(Structure):
    _fields_ = [("size", c_size_t), ("robot", c_char_p), ("task", c_char_p), ("T_task_base", POINTER(c_double)),
                ("profile", c_char_p), ("deadline_ms", c_uint32)]


class Kinship:
    def __init__(self, file):
        self.library = ctypes.CDLL(file)
        self.library.kinship_error_text.restype = c_char_p

    def __getattr__(self, name):
        def call(*arguments):
            if getattr(self.library, "kinship_" + name)(*arguments) != 0:
                sys.exit(f"{name}: {self.library.kinship_error_text().decode()}")
        return call


def main(library, models):
    kinship = Kinship(library)
    client, distribution, sampler = c_void_p(), c_void_p(), c_void_p()
    robot, dof = ctypes.create_string_buffer(32), c_size_t()
    kinship.client_open(None, byref(client))  # KINSHIP_DOMAIN and KINSHIP_SERVER
    kinship.register_file(client, byref(RobotFile(source=f"{models}/ur10e".encode())), robot, byref(dof))
    station = (c_double * 7)(0, 0, 0, 0, 0, 0, 1)
    request = Request(robot=ctypes.cast(robot, c_char_p), task=b"sweep", T_task_base=station, deadline_ms=60000)
    kinship.fetch(client, byref(request), byref(distribution))
    kinship.sampler_create(distribution, byref(sampler))
    rows = (c_double * (1000 * dof.value))()
    kinship.sampler_fill(sampler, rows, c_size_t(1000), dof, c_int(0), c_uint64(1))
    print(f"1000 samples of {dof.value} joints; the first: {rows[0]:.3f} {rows[1]:.3f} ...")
    for handle, end in ((sampler, "sampler_free"), (distribution, "distribution_free"), (client, "client_close")):
        getattr(kinship.library, "kinship_" + end)(handle)


if __name__ == "__main__":
    main(*sys.argv[1:])
