#!/usr/bin/env python3
"""A dam break from Python: nothing compiled, and a NumPy view of the positions without a copy.

    python3 ctypes_demo.py <path to libpbf.so>
"""
import ctypes as c
import sys

import numpy as np


# structs: written by tools/bindings.py
class Desc(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32), ("api_version", c.c_uint32), ("dimension", c.c_uint32),
        ("precision", c.c_uint32), ("capacity", c.c_uint32), ("strict", c.c_uint32),
        ("backend", c.c_char_p), ("device", c.c_int32), ("threads", c.c_uint32),
        ("stream", c.c_void_p), ("allocator", c.c_void_p), ("log", c.c_void_p),
        ("log_user", c.c_void_p), ("isa", c.c_char_p), ("enqueue_task", c.c_void_p),
        ("finish_task", c.c_void_p), ("task_user", c.c_void_p), ("determinism", c.c_uint32),
        ("reserved", c.c_uint32),
    ]


class Params(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32), ("kernel", c.c_uint32), ("smoothing_radius", c.c_double),
        ("spacing", c.c_double), ("particle_volume", c.c_double), ("time_step", c.c_double),
        ("iterations", c.c_uint32), ("collide", c.c_uint32), ("gravity", c.c_double * 3),
        ("attraction", c.c_double), ("attraction_center", c.c_double * 3),
        ("over_relaxation", c.c_double), ("cfm", c.c_double), ("cohesion", c.c_double),
        ("min_diagonal", c.c_double), ("wall_density", c.c_double), ("scorr_k", c.c_double),
        ("scorr_dq", c.c_double), ("scorr_n", c.c_uint32), ("solver", c.c_uint32),
        ("vorticity", c.c_double), ("viscosity", c.c_double), ("domain_min", c.c_double * 3),
        ("domain_max", c.c_double * 3), ("wall_velocity", c.c_double * 6),
        ("wall_amplitude", c.c_double * 6), ("wall_frequency", c.c_double * 6),
        ("wall_phase", c.c_double * 6), ("search_cell_width", c.c_double),
        ("sleep_speed", c.c_double), ("sleep_time", c.c_double), ("tolerance", c.c_double),
        ("pressure_grid", c.c_double), ("prestabilization", c.c_double),
        ("damping_compensation", c.c_double), ("angular_momentum_correction", c.c_double),
        ("drag", c.c_double), ("drag_velocity", c.c_double * 3),
        ("max_depenetration_speed", c.c_double), ("max_substeps", c.c_uint32),
        ("loads", c.c_uint32), ("shear_stress_correction", c.c_double),
        ("wall_friction", c.c_double), ("wall_static_friction", c.c_double),
        ("wall_no_slip", c.c_double), ("surface_tension", c.c_double), ("periodic", c.c_uint32),
        ("reserved", c.c_uint32), ("wall_adhesion", c.c_double),
    ]


class View(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32), ("field", c.c_uint32), ("device_type", c.c_uint32),
        ("device_id", c.c_int32), ("element_type", c.c_uint32), ("components", c.c_uint32),
        ("count", c.c_uint32), ("reserved", c.c_uint32), ("particle_stride", c.c_int64),
        ("component_stride", c.c_int64), ("generation", c.c_uint64), ("data", c.c_void_p),
        ("ids", c.POINTER(c.c_uint32)),
    ]
# end of structs


POSITION = 1


def main(path):
    pbf = c.CDLL(path)
    pbf.pbf_last_error.restype = c.c_char_p

    def check(status):
        if status:
            raise RuntimeError(pbf.pbf_last_error().decode())

    desc, params, fluid = Desc(), Params(), c.c_void_p()
    check(pbf.pbf_desc_init(c.byref(desc), c.sizeof(desc)))
    check(pbf.pbf_params_init(c.byref(params), c.sizeof(params)))
    grid = np.mgrid[0:10, 0:20, 0:20].reshape(3, -1).T
    start = np.ascontiguousarray(0.025 + 0.05 * grid, np.float32)
    desc.capacity = len(start)
    desc.backend = sys.argv[2].encode() if len(sys.argv) > 2 else b"auto"
    params.domain_max[0] = 2
    check(pbf.pbf_create(c.byref(desc), c.byref(params), c.byref(fluid)))
    try:
        check(pbf.pbf_add_particles(fluid, len(start), start.ctypes.data_as(c.c_void_p), None, None))
        check(pbf.pbf_step(fluid, 100))
        view = View(struct_size=c.sizeof(View))
        check(pbf.pbf_map(fluid, POSITION, c.byref(view)))
        if view.device_type == 1:  # in host memory: wrap it
            extent = ((view.count - 1) * view.particle_stride
                      + (view.components - 1) * view.component_stride + 4)
            memory = (c.c_char * extent).from_address(view.data)
            positions = np.ndarray((view.count, view.components), np.float32, memory,
                                   strides=(view.particle_stride, view.component_stride))
            print(f"{len(positions)} particles, mean {positions.mean(axis=0).round(3)}")
            copied = np.empty_like(start)
            check(pbf.pbf_get_positions(fluid, 0, len(start), copied.ctypes.data_as(c.c_void_p)))
            ids = np.ctypeslib.as_array(view.ids, (view.count,))
            assert np.array_equal(positions, copied[ids]), "view and copy differ"
        check(pbf.pbf_unmap(fluid, POSITION))
    finally:
        pbf.pbf_destroy(fluid)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1])
