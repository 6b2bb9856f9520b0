/* What derive.h derives from the parameters. */
#ifndef PBF_PHYSICS_DERIVED_H
#define PBF_PHYSICS_DERIVED_H

#include <pbf/pbf.h>

/* Nodes of what a solid does to the fluid before it, from its plane to a distance of h. */
enum { PBF_VISCOUS_WALL_NODES = 17 };

/* Of the weights w of passes/viscous_stress.h: how steep they are; on the rest lattice sum w r²,
 * and the factor on sum w (v_ji · x_ij) x_ij that makes it the laplacian of v: averaged over
 * directions x² y² is r⁴ / (d (d + 2)). Of the half-space behind a plane in the distance y the sum
 * of w x_t² x_n h / y: x_n across the plane, x_t along it. */
typedef struct pbf_viscosity_lattice {
  double falloff, spread, to_laplacian;
  double wall[PBF_VISCOUS_WALL_NODES];
} pbf_viscosity_lattice;

/* Everything the pair terms need, in units of 1/h: V W = value_scale * shape(r/h). */
typedef struct pbf_derived {
  pbf_params from; /* see pbf_params_to_derive_from */
  double h;
  double spacing;
  double volume;         /* V */
  double value_scale;    /* V times the kernel's norm: V W(0) for both kernels */
  double gradient_scale; /* V times the gradient's norm, see kernels.h */
  double cfm;            /* 1/length² */
  double omega;
  double scorr_k;
  double scorr_inv_w;   /* 1 / (V W(delta q)) */
  double scorr_dq2;     /* (delta q)² in units of h² */
  double diagonal;      /* V² sum |grad W|² on the lattice */
  double stiffness;     /* largest curvature of a pressed lattice for lambda = 1, 1/length² */
  double pressure;      /* of a lattice for lambda = -1 and a time step of 1, over rest density */
  double surface_lacks; /* density that the outermost layer of a lattice lacks */
  double wall_offset;   /* from a particle's distance to a wall to the t h that its density is taken
                           at */
  double wall_first,
      wall_first_density; /* t of a lattice's first layer, and the half-space's density there */
  double wall_steepness, wall_fade, wall_gradient_scale,
      wall_gradient_scale_far; /* see pbf_derive_wall */
  double wall_fabric_across,
      wall_fabric_along; /* what a first layer lacks of shear_stress.h's M, across and along */
  pbf_viscosity_lattice viscosity;
  double per_neighbor, neighbors_of_solids; /* see passes/surface_tension.h */
} pbf_derived;

#endif
