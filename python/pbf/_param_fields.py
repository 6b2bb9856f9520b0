"""The parameters as attributes. Written by tools/tables.py from backends/physics/params.def."""
from __future__ import annotations

from collections.abc import Sequence
from typing import TypedDict, Union

from ._numbers import Vector
from ._param_kinds import (Collide, CollideField, Holder, Integer, Kernel, KernelField, Method,
                           MethodField, Number, Periodic, PeriodicField, Reals)


class ParamFields(Holder):
    kernel = KernelField(
        "The density kernel, and the kernel whose gradient moves particles: Wendland C2 for both, "
        "or poly6 and spiky, as in the paper. Range: `PBF_KERNEL_WENDLAND_C2`, "
        "`PBF_KERNEL_POLY6_SPIKY`. Default: `PBF_KERNEL_WENDLAND_C2`.")
    smoothing_radius = Number(
        "h: the kernels vanish at distances of h and more. 1e-8 … 1e11 in float32, 1e-75 … 1e75 "
        "in float64. Unit: length. Range: > 0. Default: `0.1`.")
    spacing = Number(
        "The distance of particles at rest: below h, at least h/10; 0: h/2. Unit: length. Range: "
        "≥ 0. Default: `0`.")
    particle_volume = Number(
        "The rest volume of a particle, 1e-6 … 1000 h^dimension; 0: such that a square or cubic "
        "lattice of `spacing` has density 1. Unit: length^dimension. Range: ≥ 0. Default: `0`.")
    time_step = Number(
        "The length of a step: so long that by the sum of domain_max - domain_min in one a speed "
        "is at most 1e18, in float64 1e150. Unit: time. Range: > 0. Default: `1.0 / 120`.")
    iterations = Integer(
        "Iterations of the density solve in a step; the maximum where there is a `tolerance`. "
        "Range: ≥ 1. Default: `4`.")
    collide = CollideField(
        "When walls and colliders act within a step. Range: `PBF_COLLIDE_AFTER_PREDICTION` + "
        "`PBF_COLLIDE_IN_ITERATION` + `PBF_COLLIDE_AFTER_SOLVE`. Default: "
        "`PBF_COLLIDE_AFTER_PREDICTION` + `PBF_COLLIDE_IN_ITERATION`.")
    gravity = Reals(3,
        "The acceleration of all particles. Unit: length/time². Range: finite. Default: `{0, "
        "-9.81, 0}`.")
    attraction = Number(
        "A further acceleration, -attraction (x - attraction_center). Unit: 1/time². Range: "
        "finite. Default: `0`.")
    attraction_center = Reals(3,
        "The point that `attraction` pulls towards. Unit: length. Range: finite. Default: `{0}`.")
    over_relaxation = Number(
        "A factor on the position change of an iteration, 1 in the paper, at most 1e6; 0: from "
        "the largest eigenvalue of the Jacobi iteration on the lattice, always stable. Range: ≥ "
        "0. Default: `0`.")
    cfm = Number(
        "Constraint force mixing: the ε of eq. 11, times h². Range: ≥ 0. Default: `0`.")
    cohesion = Number(
        "How much the fluid holds together: the weight with which densities below rest pull, with "
        "PBF_SOLVER_CHEBYSHEV only inside the fluid; 1: as in the paper. Range: 0 … 1. Default: "
        "`0`.")
    min_diagonal = Number(
        "The minimum of the denominator of eq. 11, in units of that of the rest lattice; 0: as in "
        "the paper. Range: ≥ 0. Default: `1`.")
    wall_density = Number(
        "The weight of the density that walls and colliders contribute, as if they were fluid at "
        "rest; 0: as in the paper, particles pile up on walls. Range: 0 … 1. Default: `1`.")
    scorr_k = Number(
        "Artificial pressure, eq. 13: its k, at most 1e6 h²; 0: none. Unit: length². Range: ≥ 0. "
        "Default: `0`.")
    scorr_dq = Number(
        "Artificial pressure, eq. 13: its Δq. Unit: h. Range: > 0, < 1, with `scorr_k`. Default: "
        "`0.2`.")
    scorr_n = Integer(
        "Artificial pressure, eq. 13: its exponent. Range: 1 … 8, with `scorr_k`. Default: `4`.")
    solver = MethodField(
        "How the density solve iterates: as Algorithm 1, or accelerated by the Chebyshev semi- "
        "iteration, with a lambda that adds up over the iterations. Range: `PBF_SOLVER_JACOBI`, "
        "`PBF_SOLVER_CHEBYSHEV`. Default: `PBF_SOLVER_CHEBYSHEV`.")
    vorticity = Number(
        "Vorticity confinement, eq. 16, at most 1e6 h / time_step; 0: none. Unit: length/time. "
        "Range: ≥ 0. Default: `0`.")
    viscosity = Number(
        "Kinematic viscosity; with PBF_SOLVER_JACOBI XSPH's factor, eq. 17, which has no unit, 1: "
        "the maximum that acts. 0: none. Unit: length²/time. Range: ≥ 0. Default: `0`.")
    domain_min = Reals(3,
        "The lower walls of the domain. A wall stands at bound + velocity t + amplitude "
        "sin(frequency t + phase), t being the time at the end of the step. Unit: length. Range: "
        "finite. Default: `{0}`.")
    domain_max = Reals(3,
        "The upper walls of the domain. Unit: length. Range: finite. Default: `{1, 1, 1}`.")
    wall_velocity = Reals(6,
        "The walls' velocities; order: x lower, x upper, y lower, … Unit: length/time. Range: "
        "finite. Default: `{0}`.")
    wall_amplitude = Reals(6,
        "The amplitudes of the walls' oscillation. Unit: length. Range: finite. Default: `{0}`.")
    wall_frequency = Reals(6,
        "The angular frequencies of the walls' oscillation. Unit: radians/time. Range: finite. "
        "Default: `{0}`.")
    wall_phase = Reals(6,
        "The phases of the walls' oscillation. Unit: radians. Range: finite. Default: `{0}`.")
    search_cell_width = Number(
        "The cell width of the neighbour search, at least h; 0: the backend's choice. Only "
        "`reference` obeys it. Unit: length. Range: ≥ 0. Default: `0`.")
    sleep_speed = Number(
        "Fluid whose root mean square velocity over `sleep_time` is below this falls asleep; in "
        "float32 at most 1e18; 0: nothing sleeps. Unit: length/time. Range: ≥ 0. Default: `0`.")
    sleep_time = Number(
        "The time over which speeds are averaged for `sleep_speed`, with which it must be above "
        "0. Unit: time. Range: ≥ 0. Default: `0`.")
    tolerance = Number(
        "The density solve ends with the iteration that finds a mean of max(ρ/ρ₀ - 1, 0) of at "
        "most this; 0: always after `iterations`. Range: ≥ 0. Default: `0`.")
    pressure_grid = Number(
        "The cell width of a coarse grid that carries deep water; 0: none, -1: 2 with "
        "PBF_SOLVER_CHEBYSHEV where water could be deep. Unit: h. Range: -1, 0, 1 … 1000. "
        "Default: `-1`.")
    prestabilization = Number(
        "The mean density error above which a fluid that has been placed is moved to rest density "
        "before its first step, with PBF_SOLVER_CHEBYSHEV; 0: never. Range: ≥ 0. Default: `0.02`.")
    damping_compensation = Number(
        "How much of the fluid's motion that a step takes by pushing along directions at its end "
        "is given back. Range: 0 … 1; 0 unless `PBF_SOLVER_CHEBYSHEV`. Default: `0`.")
    angular_momentum_correction = Number(
        "How much of the torque that pushes between particles exert goes back to the pairs around "
        "as velocity; -1: 1 with PBF_SOLVER_CHEBYSHEV and without gravity, 0 elsewhere. Range: "
        "-1, 0 … 1; 0 unless `PBF_SOLVER_CHEBYSHEV`. Default: `-1`.")
    drag = Number(
        "The rate at which all particles are dragged towards `drag_velocity`, as by a wind or a "
        "stream around them; 0: none. Unit: 1/time. Range: ≥ 0. Default: `0`.")
    drag_velocity = Reals(3,
        "The velocity that `drag` leads to. Unit: length/time. Range: finite. Default: `{0}`.")
    max_depenetration_speed = Number(
        "What overlaps parts no faster: particles found in colliders, or placed upon others; 0: "
        "√(|gravity| h). Unit: length/time. Range: ≥ 0. Default: `0`.")
    max_substeps = Integer(
        "Into how many parts the library may divide a step that is too long; 0 or 1: none. Range: "
        "0 … 1000. Default: `0`.")
    loads = Integer(
        "1: each step finds what the fluid does to walls and colliders, for "
        "`pbf_get_collider_loads` and `pbf_get_wall_loads`; 0: it does not. Range: 0 … 1. "
        "Default: `0`.")
    shear_stress_correction = Number(
        "How much of the shear stress that pushes along pairs have under pressure is taken back, "
        "so that slow eddies live on; -1: with PBF_SOLVER_CHEBYSHEV 0.75 where water could be 18 "
        "layers deep or has a surface tension, 0.65 where weightless fluid fills its box, less "
        "with wide kernels, 0 elsewhere. Range: -1, 0 … 1; 0 unless `PBF_SOLVER_CHEBYSHEV`. "
        "Default: `-1`.")
    wall_friction = Number(
        "Coulomb friction of the domain's walls: how much of what a wall pushes with acts along "
        "it against a particle's motion; 0: none. Range: ≥ 0. Default: `0`.")
    wall_static_friction = Number(
        "The same for what is at rest on a wall; below `wall_friction` that. Range: ≥ 0. Default: "
        "`0`.")
    wall_no_slip = Number(
        "How much of the fluid's shear, by its `viscosity`, acts between the domain's walls and "
        "the fluid at them, with PBF_SOLVER_CHEBYSHEV: from 0, where it slides freely, to 1, "
        "where it sticks. Range: 0 … 1. Default: `0`.")
    surface_tension = Number(
        "Surface tension over rest density; in 3D at most 0.02, in 2D 0.05 spacing³ / time_step² "
        "of it act; 0: none. Unit: length³/time². Range: ≥ 0; 0 unless `PBF_SOLVER_CHEBYSHEV`. "
        "Default: `0`.")
    periodic = PeriodicField(
        "The axes along which the domain's two faces are one: what leaves it by the one comes in "
        "by the other. Range: `PBF_PERIODIC_X` + `PBF_PERIODIC_Y` + `PBF_PERIODIC_Z`. Default: "
        "`0`.")
    wall_adhesion = Number(
        "How much fluid with a `surface_tension` adheres to the domain's walls: half of 1 + the "
        "cosine of the contact angle, 0.25 for 120, 0.5 for 90, 0.75 for 60 degrees; 0: 180, "
        "nothing adheres. Range: 0 … 1. Default: `0`.")


class ParamValues(TypedDict, total=False):
    """What the parameters' keywords take."""

    kernel: "Union[Kernel, int, str]"
    smoothing_radius: float
    spacing: float
    particle_volume: float
    time_step: float
    iterations: int
    collide: "Union[Collide, int, str, Sequence[str]]"
    gravity: Vector
    attraction: float
    attraction_center: Vector
    over_relaxation: float
    cfm: float
    cohesion: float
    min_diagonal: float
    wall_density: float
    scorr_k: float
    scorr_dq: float
    scorr_n: int
    solver: "Union[Method, int, str]"
    vorticity: float
    viscosity: float
    domain_min: Vector
    domain_max: Vector
    wall_velocity: Vector
    wall_amplitude: Vector
    wall_frequency: Vector
    wall_phase: Vector
    search_cell_width: float
    sleep_speed: float
    sleep_time: float
    tolerance: float
    pressure_grid: float
    prestabilization: float
    damping_compensation: float
    angular_momentum_correction: float
    drag: float
    drag_velocity: Vector
    max_depenetration_speed: float
    max_substeps: int
    loads: int
    shear_stress_correction: float
    wall_friction: float
    wall_static_friction: float
    wall_no_slip: float
    surface_tension: float
    periodic: "Union[Periodic, int, str, Sequence[str]]"
    wall_adhesion: float
