/* What colliders do on the pressure grid that go faster or slower in a step than in the one before:
 * a piston that starts, a lift, a truck that brakes. Fluid before a solid moves along with it
 * already, but not with what the solid's moves gain. With b that gain, n pointing into the solid,
 *
 *   integral over its surface of  N_node b · n  =  sum over the cells e at a node of  volume_e b ·
 * grad N_node
 *
 * to be added to the right side, which holds where b is one vector around the node, whatever cells
 * the surface cuts: around a node with none b counts for nothing. (The domain's walls have it in
 * the grid itself.) */
#ifndef PBF_PHYSICS_PRESSURE_GRID_SOLID_GAINS_H
#define PBF_PHYSICS_PRESSURE_GRID_SOLID_GAINS_H

#include "physics/pressure_grid/topology.h"

/* In cells: nothing farther from a node cuts a cell around it. */
#define PBF_GAIN_REACH 1.5

/* b at a node. */
typedef struct pbf_node_gain {
  pbf_vec x, gain;
  double nearest; /* of those that gain; at first the reach */
} pbf_node_gain;

PBF_FN pbf_node_gain pbf_node_gain_begin(const pbf_pressure_grid *c, const int i[PBF_DIM]) {
  pbf_node_gain node;
  for (int k = 0; k < PBF_DIM; ++k) {
    node.x.c[k] = (pbf_real)(c->lower[k] + (i[k] - 1) * c->width);
    node.gain.c[k] = 0;
  }
  node.nearest = PBF_GAIN_REACH * c->width;
  return node;
}

/* First it is that of the nearest one, … */
template <class Surface>
PBF_FN void pbf_node_gain_look(const Surface *s, pbf_node_gain *node) {
  pbf_vec normal;
  if (!s->gains) return;
  const double distance = (double)pbf_surface_distance(s, node->x, &normal);
  if (!(distance < node->nearest)) return;
  node->nearest = distance;
  node->gain = pbf_surface_gain_at(s, node->x);
}

/* … and then along their normals that of others, or nothing where these are nearer and stand. */
template <class Surface>
PBF_FN void pbf_node_gain_settle(const pbf_pressure_grid *c, const Surface *s,
                                 pbf_node_gain *node) {
  pbf_vec normal, gain = {{0}};
  const double distance = (double)pbf_surface_distance(s, node->x, &normal);
  if (!(distance < (s->gains ? PBF_GAIN_REACH * c->width : node->nearest))) return;
  if (s->gains) gain = pbf_surface_gain_at(s, node->x);
  const pbf_real more = pbf_dot(pbf_sub(gain, node->gain), normal);
  node->gain = pbf_add_scaled(node->gain, more, normal);
}

/* From the cell, or a compartment of it, of which the node is corner `a`. */
PBF_FN double pbf_node_gain_of_cell(const pbf_pressure_grid *c, const pbf_node_gain *node,
                                    double free_volume, int a) {
  double sum = 0;
  for (int k = 0; k < PBF_DIM; ++k) sum += (a >> k & 1 ? 1 : -1) * (double)node->gain.c[k];
  return free_volume * sum * c->per_width * 2 / PBF_CORNERS;
}

/* What the right side of a node inside gets. */
PBF_FN double pbf_gain_at_node(const pbf_pressure_grid *c, double part, const double *free_volumes,
                               const pbf_node_gain *node, uint32_t index) {
  double sum = 0;
  for (int a = 0; a < PBF_CORNERS; ++a)
    sum += pbf_node_gain_of_cell(c, node, free_volumes[(int64_t)index - (int64_t)c->corner[a]], a);
  return part * sum;
}

/* Of a torn node. */
PBF_FN double pbf_gain_at_torn_node(const pbf_pressure_grid *c, const pbf_pressure_grid_topology *t,
                                    double part, const double *free_volumes,
                                    const pbf_node_gain *node, uint32_t torn) {
  double sum = 0;
  pbf_for_compartments(t, torn, [&](uint32_t compartment, int a) {
    sum += pbf_node_gain_of_cell(c, node, free_volumes[compartment], a);
  });
  return part * sum;
}

#endif
