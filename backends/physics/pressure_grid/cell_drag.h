/* What drag does on the pressure grid. Drag (passes/drag.h) changes velocities at the end of a
 * step, so that in the next one it is a force beside weight, and in fluid that walls keep at rest
 * pressure has to stand against it. It goes by velocity: a cell has that of its particles, on
 * average, and there is no pressure where fluid goes with the wind. Summed up where there is drag
 * alone. */
#ifndef PBF_PHYSICS_PRESSURE_GRID_CELL_DRAG_H
#define PBF_PHYSICS_PRESSURE_GRID_CELL_DRAG_H

#include "physics/pressure_grid/topology.h"

/* Moves are summed up as integers, which have the same sum in any order: in so many parts of a
 * cell, at most four cells each, so that the sum of 2^24 particles fits. */
#define PBF_CELL_MOVE_UNIT 4294967296.0
#define PBF_CELL_MOVE_MAX 4.0

/* What a particle adds to its cell's sum along an axis: its move at the velocity of the prediction.
 */
PBF_FN int64_t pbf_cell_move_entry(const pbf_pressure_grid *c, pbf_real velocity) {
  const double move = c->move * (double)velocity;
  return (int64_t)(pbf_greater(pbf_lesser(move, PBF_CELL_MOVE_MAX), -PBF_CELL_MOVE_MAX) *
                   PBF_CELL_MOVE_UNIT);
}

/* What the drag of the last step adds to the move of a cell, the i-th along an axis, in this one:
 * its particles' mean without what the other forces add. */
PBF_FN double pbf_cell_drag(const pbf_pressure_grid *c, int64_t count, int64_t moves, int axis,
                            int i) {
  const double predicted = (double)moves / (PBF_CELL_MOVE_UNIT * (double)count);
  const double at_start = predicted - (c->push[axis] + c->pull[axis] * i);
  return c->drag * (at_start - c->drag_move[axis]);
}

/* Over the cells around a node. Those that hold no particle have the mean of the others. */
typedef struct pbf_node_drag {
  double sum, without[PBF_DIM], all[PBF_DIM];
  int cells;
} pbf_node_drag;

/* The cell, or a compartment of it, of which the node, the i-th along each axis, is corner `a`. */
PBF_FN void pbf_add_cell_drag(const pbf_pressure_grid *c, const int64_t *sums, const int64_t *moves,
                              const double *free_volumes, int64_t cell, const int i[PBF_DIM], int a,
                              pbf_node_drag *node) {
  const int64_t count = pbf_pressure_grid_count(sums[cell]);
  node->cells += count > 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    const int right_of = a >> k & 1;
    const double area = (right_of ? 1 : -1) * free_volumes[cell];
    if (count > 0) {
      const double drag = pbf_cell_drag(c, count, moves[PBF_DIM * cell + k], k, i[k] - right_of);
      node->sum += area * drag;
      node->all[k] += drag;
    } else {
      node->without[k] += area;
    }
  }
}

/* What a node's right side gets. */
PBF_FN double pbf_node_drag_right(double part, const pbf_node_drag *node) {
  double sum = node->sum;
  if (node->cells == 0) return 0;
  for (int k = 0; k < PBF_DIM; ++k) sum += node->without[k] * node->all[k] / node->cells;
  return -part * sum * 2 / PBF_CORNERS;
}

/* Of a node inside. */
PBF_FN double pbf_drag_at_node(const pbf_pressure_grid *c, double part, const int64_t *sums,
                               const int64_t *moves, const double *free_volumes, uint32_t node) {
  pbf_node_drag drag = {0, {0}, {0}, 0};
  int i[PBF_DIM];
  pbf_pressure_grid_place(c, node, i);
  for (int a = 0; a < PBF_CORNERS; ++a)
    pbf_add_cell_drag(c, sums, moves, free_volumes, (int64_t)node - (int64_t)c->corner[a], i, a,
                      &drag);
  return pbf_node_drag_right(part, &drag);
}

/* Of a torn node. */
PBF_FN double pbf_drag_at_torn_node(const pbf_pressure_grid *c, const pbf_pressure_grid_topology *t,
                                    double part, const int64_t *sums, const int64_t *moves,
                                    const double *free_volumes, uint32_t torn) {
  pbf_node_drag drag = {0, {0}, {0}, 0};
  int i[PBF_DIM];
  pbf_pressure_grid_place(c, t->base[torn], i);
  pbf_for_compartments(t, torn, [&](uint32_t compartment, int a) {
    pbf_add_cell_drag(c, sums, moves, free_volumes, compartment, i, a, &drag);
  });
  return pbf_node_drag_right(part, &drag);
}

#endif
