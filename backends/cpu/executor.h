/* Part of step.h: the stages of physics/step.h as loops of the team. */
#ifndef PBF_CPU_EXECUTOR_H
#define PBF_CPU_EXECUTOR_H

#include "cpu/pressure_grid.h"
#include "cpu/sleep.h"
#include "cpu/solve.h"
#include "cpu/sort.h"
#include "cpu/velocities.h"
#include "physics/passes/predict.h"
#include "physics/step.h"

static void predict_piece(void *context, uint32_t piece) {
  worker *w = static_cast<worker *>(context);
  range all = piece_particles(w, piece);
  for (range r = awake_particles(w, all.first, all.last); r.first < r.last;
       r = awake_particles(w, r.last, all.last))
    w->s->kernels->predict(&w->forces, &w->obstacles, w->s->schedule.collide_after_prediction,
                           w->b.x, w->b.v, w->b.predicted(), w->b.predicted_velocity(), r.first,
                           r.last);
  keep_places(w, all, &w->b.x, &w->b.predicted());
  keep_still(w, all, w->b.predicted_velocity().c, PBF_DIM);
  find_bounds(w, piece);
}

/* All threads of the team come to all of its loops. */
struct executor {
  worker *w;
  bool sorted; /* the step has come as far as that */

  void over_pairs(team_piece piece, team_last last = NULL) {
    team_for(w->me, pair_pieces(w), piece, last, w);
  }
  void over_pairs(team_piece piece, pbf_stage stage) {
    over_pairs(piece);
    stage_end(w, stage);
  }

  bool wake() {
    if (!sorted && sleep_is_on(w) && pbf_any_moves(w->s->movers))
      team_for(w->me, particle_pieces(w), wake_piece, NULL, w);
    return true; /* steps of none awake are not begun: steps_asleep */
  }
  void predict() {
    if (sorted) return;
    team_for(w->me, particle_pieces(w), predict_piece, make_grid, w);
    stage_end(w, PBF_STAGE_PREDICT);
  }
  bool find_neighbors() {
    if (!sorted) sort_particles(w);
    w->unrest = w->b.sorted_unrest;
    w->sleeping_lambda = w->b.sorted_sleeping_lambda;
    if (!::find_neighbors(w, is_deep(w) ? end_deep_search : end_search)) return false;
    if (corrects_torque(w)) over_pairs(start_piece);
    stage_end(w, PBF_STAGE_NEIGHBORS);
    return true;
  }
  void slack() { find_slack(w); }
  void begin_solve() {}
  void pressure_grid() { carry_weight(w); }
  bool is_over(uint32_t) const { return false; } /* see ::is_over */
  void begin_iteration(uint32_t k) {
    w->iteration = k;
    pbf_set_iteration(&w->constants, k);
  }
  void lambda(uint32_t) {
    const int watched = is_watched(w->s);
    over_pairs(watched ? watched_lambda_piece : lambda_piece, watched ? end_when_small : NULL);
    stage_end(w, PBF_STAGE_LAMBDA);
  }
  void torque(uint32_t) { over_pairs(torque_piece, PBF_STAGE_TORQUE); }
  void move(uint32_t k) {
    over_pairs(is_watched(w->s) ? watched_move_piece : move_piece);
    w->b.accept_iteration();
    stage_end(w, PBF_STAGE_MOVE);
    w->iteration = k + 1;
  }
  void velocity() { update_velocity(w); }
  void flow() {
    pack_vectors(w, velocities_piece);
    over_pairs(flow_piece, PBF_STAGE_FLOW);
  }
  void undamp() {
    pack_vectors(w, flows_and_lambda_piece);
    over_pairs(undamp_piece, PBF_STAGE_UNDAMP);
  }
  void turn_rate() { over_pairs(turn_rate_piece, PBF_STAGE_TURN_RATE); }
  void turn() {
    pack_vectors(w, rates_piece);
    over_pairs(turn_piece, PBF_STAGE_TURN);
  }
  void curl() {
    pack_vectors(w, velocities_piece);
    over_pairs(curl_piece, PBF_STAGE_CURL);
  }
  void confine() {
    pack_positions(w, sizes_piece);
    over_pairs(confine_piece, PBF_STAGE_CONFINE);
  }
  void viscosity() {
    pack_vectors(w, velocities_piece);
    over_pairs(viscosity_piece);
    w->b.accept_smoothed_velocity();
    stage_end(w, PBF_STAGE_VISCOSITY);
  }
  void drag() { over_pairs(drag_piece, PBF_STAGE_DRAG); }
  bool settle() { return ::settle(w); }
  void end() {}
};

#endif
