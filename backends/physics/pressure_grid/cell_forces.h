/* What forces do on the pressure grid that differ from particle to particle: accelerations of their
 * own, and drag. Where walls keep fluid at rest, pressure has to stand against them as against
 * weight. A cell moves by what they are to its particles, on average. Drag (passes/drag.h) changes
 * velocities at the end of a step, so that in the next one it is such a force; it goes by velocity,
 * and there is no pressure where fluid goes with the wind. Summed up where there are such forces
 * alone. */
#ifndef PBF_PHYSICS_PRESSURE_GRID_CELL_FORCES_H
#define PBF_PHYSICS_PRESSURE_GRID_CELL_FORCES_H

#include "physics/pressure_grid/topology.h"

/* Moves are summed up as integers, which have the same sum in any order: in so many parts of a
 * cell, at most four cells each, so that the sum of 2^24 particles fits. */
#define PBF_CELL_MOVE_UNIT 4294967296.0
#define PBF_CELL_MOVE_MAX 4.0

/* What a particle adds to its cell's sum along an axis: its move by its own acceleration, and what
 * drag adds of that at the velocity of the prediction without it. */
PBF_FN int64_t pbf_cell_move_entry(const pbf_pressure_grid *c, pbf_real velocity,
                                   pbf_real acceleration) {
  const double accelerated = c->accelerated * (double)acceleration;
  const double move = accelerated + c->drag * (c->move * (double)velocity - accelerated);
  return (int64_t)(pbf_max(pbf_min(move, PBF_CELL_MOVE_MAX), -PBF_CELL_MOVE_MAX) *
                   PBF_CELL_MOVE_UNIT);
}

/* The move of a cell, the i-th along an axis, by such forces: its particles' mean, and of drag
 * without what the forces add that all particles have alike. */
PBF_FN double pbf_cell_move(const pbf_pressure_grid *c, int64_t count, int64_t moves, int axis,
                            int i) {
  const double mean = (double)moves / (PBF_CELL_MOVE_UNIT * (double)count);
  return mean - c->drag * (c->push[axis] + c->pull[axis] * i + c->drag_move[axis]);
}

/* Over the cells around a node. Those that hold no particle have the mean of the others. */
typedef struct pbf_node_moves {
  double sum, without[PBF_DIM], all[PBF_DIM];
  int cells;
} pbf_node_moves;

/* The cell, or a compartment of it, of which the node, the i-th along each axis, is corner `a`. */
PBF_FN void pbf_add_cell_move(const pbf_pressure_grid *c, const int64_t *sums, const int64_t *moves,
                              const double *free_volumes, int64_t cell, const int i[PBF_DIM], int a,
                              pbf_node_moves *node) {
  const int64_t count = pbf_pressure_grid_count(sums[cell]);
  node->cells += count > 0;
  for (int k = 0; k < PBF_DIM; ++k) {
    const int right_of = a >> k & 1;
    const double area = (right_of ? 1 : -1) * free_volumes[cell];
    if (count > 0) {
      const double move = pbf_cell_move(c, count, moves[PBF_DIM * cell + k], k, i[k] - right_of);
      node->sum += area * move;
      node->all[k] += move;
    } else {
      node->without[k] += area;
    }
  }
}

/* What a node's right side gets. */
PBF_FN double pbf_node_moves_right(double part, const pbf_node_moves *node) {
  double sum = node->sum;
  if (node->cells == 0) return 0;
  for (int k = 0; k < PBF_DIM; ++k) sum += node->without[k] * node->all[k] / node->cells;
  return -part * sum * 2 / PBF_CORNERS;
}

/* Of a node inside. */
PBF_FN double pbf_moves_at_node(const pbf_pressure_grid *c, double part, const int64_t *sums,
                                const int64_t *moves, const double *free_volumes, uint32_t node) {
  pbf_node_moves around = {0, {0}, {0}, 0};
  int i[PBF_DIM];
  pbf_pressure_grid_place(c, node, i);
  for (int a = 0; a < PBF_CORNERS; ++a)
    pbf_add_cell_move(c, sums, moves, free_volumes, (int64_t)node - (int64_t)c->corner[a], i, a,
                      &around);
  return pbf_node_moves_right(part, &around);
}

/* Of a torn node. */
PBF_FN double pbf_moves_at_torn_node(const pbf_pressure_grid *c,
                                     const pbf_pressure_grid_topology *t, double part,
                                     const int64_t *sums, const int64_t *moves,
                                     const double *free_volumes, uint32_t torn) {
  pbf_node_moves around = {0, {0}, {0}, 0};
  int i[PBF_DIM];
  pbf_pressure_grid_place(c, t->base[torn], i);
  pbf_for_compartments(t, torn, [&](uint32_t compartment, int a) {
    pbf_add_cell_move(c, sums, moves, free_volumes, compartment, i, a, &around);
  });
  return pbf_node_moves_right(part, &around);
}

#endif
