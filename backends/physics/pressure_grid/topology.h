/* The copies of nodes that thin solids tear apart (compartments.h), and the compartments that each
 * is a corner of. */
#ifndef PBF_PHYSICS_PRESSURE_GRID_TOPOLOGY_H
#define PBF_PHYSICS_PRESSURE_GRID_TOPOLOGY_H

#include "physics/pressure_grid/compartments.h"

/* At the faces of a periodic axis, which are one, the nodes of the first cells are those of the
 * last ones, too: these have them as corners, and what would be their own lie outside. */
PBF_FN int pbf_node_is_beyond(const pbf_pressure_grid *c, const int i[PBF_DIM]) {
  int any = 0;
  for (int k = 0; k < PBF_DIM; ++k) any |= c->wrap[k] && i[k] > c->n[k];
  return any;
}

/* The cells around a node, by the corner that it is of each. */
typedef struct pbf_node_cells {
  uint32_t cells[PBF_CORNERS];
  int counts[PBF_CORNERS]; /* of compartments; 0 outside */
} pbf_node_cells;

PBF_FN pbf_node_cells pbf_cells_around_node(const pbf_pressure_grid *c,
                                            const pbf_pressure_grid_topology *t, uint32_t node) {
  pbf_node_cells around;
  int i[PBF_DIM], at[PBF_DIM];
  pbf_pressure_grid_place(c, node, i);
  for (int a = 0; a < PBF_CORNERS; ++a) {
    around.cells[a] = node - c->corner[a];
    for (int k = 0; k < PBF_DIM; ++k) {
      at[k] = i[k] - (a >> k & 1);
      if (at[k] > 0 || !c->wrap[k]) continue;
      at[k] = c->n[k];
      around.cells[a] += c->wrap[k];
    }
    const int is_inside = pbf_cell_is_inside(c, at) && !pbf_node_is_beyond(c, i);
    around.counts[a] = is_inside ? pbf_cell_compartments(t, around.cells[a]) : 0;
  }
  return around;
}

PBF_FN int pbf_node_is_inside(const pbf_pressure_grid *c, uint32_t node) {
  int i[PBF_DIM];
  pbf_pressure_grid_place(c, node, i);
  for (int k = 0; k < PBF_DIM; ++k)
    if (i[k] == 0) return 0;
  return 1;
}

PBF_FN int pbf_is_around(const uint32_t *marks, const pbf_node_cells *around) {
  int any = 0;
  for (int a = 0; a < PBF_CORNERS; ++a)
    if (around->counts[a] && marks[around->cells[a]]) any = 1;
  return any;
}

PBF_FN int pbf_cut_is_around(const pbf_pressure_grid_topology *t, const pbf_node_cells *around) {
  int any = 0;
  for (int a = 0; a < PBF_CORNERS; ++a) any |= pbf_cell_is_cut(t, around->cells[a]);
  return any;
}

/* Whether a cell is around it that lies at the other face of a periodic axis. */
PBF_FN int pbf_wraps_around(const pbf_pressure_grid *c, const pbf_node_cells *around,
                            uint32_t node) {
  int any = 0;
  for (int a = 0; a < PBF_CORNERS; ++a)
    any |= around->counts[a] && around->cells[a] + c->corner[a] != node;
  return any;
}

/* Marks each compartment around a node with the lowest number of those that it is connected with:
 * compartment k of the cell of which the node is corner a has PBF_COMPARTMENTS a + k. */
PBF_FN_HOST_NOINLINE void pbf_connect_around_node(const pbf_pressure_grid_topology *t,
                                                  const pbf_node_cells *around,
                                                  uint8_t marks[PBF_CORNERS * PBF_COMPARTMENTS]) {
  for (int m = 0; m < PBF_CORNERS * PBF_COMPARTMENTS; ++m) marks[m] = (uint8_t)m;
  for (int changes = 1; changes;) {
    changes = 0;
    for (int a = 0; a < PBF_CORNERS; ++a)
      for (int axis = 0; axis < PBF_DIM; ++axis) {
        const int low = a | 1 << axis; /* the cell before that one along the axis */
        if (low == a) continue;
        for (int k = 0; k < around->counts[low]; ++k)
          for (int l = 0; l < around->counts[a]; ++l) {
            uint8_t *one = &marks[PBF_COMPARTMENTS * low + k];
            uint8_t *other = &marks[PBF_COMPARTMENTS * a + l];
            if (*one == *other ||
                !pbf_cell_link(t, around->cells[low], around->cells[a], axis, k, l))
              continue;
            *one = *other = *one < *other ? *one : *other;
            changes = 1;
          }
      }
  }
}

/* Gives each of the unconnected groups around a node its own copy. Where no index is left, they
 * share the first. */
PBF_FN void pbf_tear_node(const pbf_pressure_grid *c, const pbf_pressure_grid_topology *t,
                          uint32_t node) {
  const pbf_node_cells around = pbf_cells_around_node(c, t, node);
  uint8_t marks[PBF_CORNERS * PBF_COMPARTMENTS];
  if (!pbf_cut_is_around(t, &around) && !pbf_wraps_around(c, &around, node)) return;
  pbf_connect_around_node(t, &around, marks);
  int first = 1;
  for (int m = 0; m < PBF_CORNERS * PBF_COMPARTMENTS; ++m) {
    uint32_t copy = PBF_NO_INDEX;
    for (int a = 0; a < PBF_CORNERS; ++a)
      for (int k = 0; k < around.counts[a]; ++k) {
        const uint32_t cell = around.cells[a], compartment = pbf_cell_compartment(t, cell, k);
        if (marks[PBF_COMPARTMENTS * a + k] != m || !pbf_compartment_is_own(t, compartment))
          continue;
        if (copy == PBF_NO_INDEX) {
          copy = node;
          if (!first) {
            const uint32_t taken =
                pbf_pressure_grid_take(&t->counts[PBF_FURTHER_COPIES], 1, t->max_further);
            if (taken != PBF_NO_INDEX) copy = t->first + taken;
          }
          first = 0;
        }
        if (copy == cell + c->corner[a] && compartment < t->first) continue;
        t->corners[(uint64_t)compartment * PBF_CORNERS + (uint64_t)a] = copy;
        t->touched[cell] = 1;
      }
  }
}

/* The corners of the compartments around a torn node are no longer those of their cells: a list for
 * each copy. */
PBF_FN void pbf_list_node_compartments(const pbf_pressure_grid *c,
                                       const pbf_pressure_grid_topology *t,
                                       const pbf_node_cells *around, uint32_t node, uint32_t copy) {
  const uint32_t torn = pbf_pressure_grid_take(&t->counts[PBF_TORN_NODES], 1, t->limit);
  uint32_t *node_compartments = t->node_compartments + (uint64_t)torn * PBF_NODE_COMPARTMENTS;
  int count = 0;
  t->torn[copy] = 1 + torn;
  t->torn_at[torn] = copy;
  t->base[torn] = node;
  for (int a = 0; a < PBF_CORNERS; ++a)
    for (int k = 0; k < around->counts[a]; ++k) {
      const uint32_t compartment = pbf_cell_compartment(t, around->cells[a], k);
      if (count == PBF_NODE_COMPARTMENTS || !pbf_compartment_is_own(t, compartment) ||
          pbf_pressure_grid_corner(c, t, compartment, a) != copy)
        continue;
      node_compartments[count++] = compartment * PBF_CORNERS + (uint32_t)a;
    }
  for (; count < PBF_NODE_COMPARTMENTS; ++count) node_compartments[count] = PBF_NO_INDEX;
}

/* Once all nodes have been torn. */
PBF_FN void pbf_list_torn_node(const pbf_pressure_grid *c, const pbf_pressure_grid_topology *t,
                               uint32_t node) {
  const pbf_node_cells around = pbf_cells_around_node(c, t, node);
  int i[PBF_DIM];
  pbf_pressure_grid_place(c, node, i);
  if (!pbf_is_around(t->touched, &around) && !pbf_node_is_beyond(c, i)) return;
  pbf_list_node_compartments(c, t, &around, node, node);
  for (int a = 0; a < PBF_CORNERS; ++a)
    for (int k = 0; k < around.counts[a]; ++k) {
      const uint32_t compartment = pbf_cell_compartment(t, around.cells[a], k);
      if (!pbf_compartment_is_own(t, compartment)) continue;
      const uint32_t copy = pbf_pressure_grid_corner(c, t, compartment, a);
      if (copy != node && !t->torn[copy]) pbf_list_node_compartments(c, t, &around, node, copy);
    }
}

/* ---- A torn node's compartments ------------------------------------------------------------- */

/* Calls visit(compartment, corner) for each, and the corner of it that the node is. */
template <class Visit>
PBF_FN void pbf_for_compartments(const pbf_pressure_grid_topology *t, uint32_t torn, Visit visit) {
  const uint32_t *of_node = t->node_compartments + (uint64_t)torn * PBF_NODE_COMPARTMENTS;
  for (int k = 0; k < PBF_NODE_COMPARTMENTS && of_node[k] != PBF_NO_INDEX; ++k)
    visit(of_node[k] / PBF_CORNERS, (int)(of_node[k] % PBF_CORNERS));
}

/* The node next to a torn one towards one side of an axis; PBF_NO_INDEX where there is none. */
PBF_FN uint32_t pbf_node_beside_torn(const pbf_pressure_grid *c,
                                     const pbf_pressure_grid_topology *t, uint32_t torn, int axis,
                                     int upwards) {
  uint32_t beside = PBF_NO_INDEX;
  pbf_for_compartments(t, torn, [&](uint32_t compartment, int a) {
    if (beside == PBF_NO_INDEX && (a >> axis & 1) != upwards)
      beside = pbf_pressure_grid_corner(c, t, compartment, a ^ 1 << axis);
  });
  return beside;
}

#endif
