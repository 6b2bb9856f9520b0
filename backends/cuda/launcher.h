/* Part of executor.h: what a step's stages are launched by: the particles and arguments that they
 * have in common, and on ranks exchanges with others, beside which what no other rank holds is
 * worked on. */
#ifndef PBF_CUDA_LAUNCHER_H
#define PBF_CUDA_LAUNCHER_H

#include "cuda/launches.h"
#include "cuda/pressure_grid_host.h"
#include "cuda/ranges.h"
#include "physics/overfull.h"
#include "physics/step.h"

namespace {

/* Once a call has failed, what comes later launches nothing. */
struct launcher {
  solver *s;
  double time;  /* at which the step ends, … */
  uint64_t nth; /* … of its length */
  prediction prediction_inputs;
  neighborhood n;
  iteration_extras extras;
  iteration_place place = {};
  point *moved;                    /* where a move goes */
  pbf_vec *changes = nullptr;      /* of velocities, by viscosity, … */
  pbf_vec *next_changes = nullptr; /* … and by its next stage */
  lambda_sums<pbf_real> *ghosts;   /* where walls have them, else null */
  pbf_status status;               /* of the first call that failed */
  bool moves_later = false;        /* on ranks: others do not know the last moves */
  bool in_two_parts = false;       /* on ranks: edges beside the rest, and beside exchanges */
  int turn = 0;                    /* of the event that edges record next */

  /* Between these colliders. */
  launcher(solver *of, double end, uint64_t which, const pbf_surface *surfaces)
      : s(of), time(end), nth(which) {
    const pbf_schedule &has = s->schedule;
    extras = {{pbf_domain_at(&s->params, time, s->schedule.close_phases), (int)s->collider_count,
               surfaces},
              has.wall_density,
              s->total,
              {},
              {}};
    if (PBF_SLEEP && s->activity)
      extras.rest = {s->other_activity, &s->tally->all, s->velocities, s->sleep};
    prediction_inputs = {pbf_forces_of(&s->params, time - s->params.time_step), extras.obstacles,
                         has.collide_after_prediction, pbf_periods_of(&s->params)};
    n = neighborhood_of(s,
                        grid_over(&domain(), &prediction_inputs.periods, s->params.smoothing_radius,
                                  grid_cell_limit(particles_of_all(s)), PBF_FINEST));
    pbf_set_constants_of_step(&n.constants, &s->constants, &s->params, particles_of_all(s), &has,
                              time);
    moved = s->points;
    ghosts = ghosts_between(s, domain());
    status = PBF_OK;
  }

  const pbf_domain &domain() const { return extras.obstacles.domain; }

  /* Runs launches(), which puts into `status` what they can tell at once. */
  template <class Launches>
  void run(pbf_stage stage, Launches launches) {
    const pbf_cuda_range range(pbf_stage_name(stage));
    if (status == PBF_OK) status = clock_begin(&s->clock, s->stream);
    if (status == PBF_OK) launches();
    if (status == PBF_OK) status = pbf_cuda_check_launch(pbf_stage_name(stage));
    if (status == PBF_OK) status = clock_end(&s->clock, s->stream, stage);
  }

  /* A thread a particle. */
  template <class... Parameters, class... Arguments>
  void launch(void (*kernel)(Parameters...), const Arguments &...arguments) {
    if (own_count(n)) launch_early(s, kernel, blocks_for(own_count(n)), PBF_BLOCK, 0, arguments...);
  }

  /* Of these particles. */
  template <class... Parameters, class... Arguments>
  void launch_of(const neighborhood &part, void (*kernel)(Parameters...),
                 const Arguments &...arguments) {
    if (own_count(part))
      launch_early(s, kernel, blocks_for(own_count(part)), PBF_BLOCK, 0, part, arguments...);
  }

  /* Those that a rank holds of others, too; without ranks, all. */
  sorted_particles held() const {
    sorted_particles all = n.particles;
    if (has_ranks(s)) all.first = s->ranks.pad, all.count = s->ranks.held;
    return all;
  }
  template <class... Parameters, class... Arguments>
  void launch_held(void (*kernel)(Parameters...), const Arguments &...arguments) {
    const sorted_particles all = held();
    if (all.count > all.first)
      launch_early(s, kernel, blocks_for(all.count - all.first), PBF_BLOCK, 0, all, arguments...);
  }

  bool shear_stress_is_due() const { return pbf_shear_stress_is_due(nth); }

  /* Where the solve has left points that nothing reads any more: the sizes of curls, … */
  pbf_real *curl_sizes() const { return reinterpret_cast<pbf_real *>(s->other); }

  /* … and what particles lack of neighbours. */
  pbf_real *missing() const { return reinterpret_cast<pbf_real *>(s->other); }

  /* Neighbours are read where they are; on ranks others' are copies. */
  void exchange(int fields) {
    if (has_ranks(s) && status == PBF_OK) exchange_with_ranks(fields);
  }

  /* Whether a stage after the solve, or after the shear's stages, reads places of neighbours. */
  bool reads_places_later() const {
    const auto &has = s->schedule.runs;
    return (has[PBF_STAGE_SHEAR_STRESS] && shear_stress_is_due()) || has[PBF_STAGE_MEAN_VELOCITY] ||
           has[PBF_STAGE_ANGULAR_MOMENTUM] || has[PBF_STAGE_CURL] || has[PBF_STAGE_SLEEP] ||
           has[PBF_STAGE_SURFACE_TENSION] || (has[PBF_STAGE_VISCOSITY] && !s->schedule.accelerated);
  }

  rank_field field_of(int field) {
    switch (field) {
      case FIELD_LAMBDA:
      case FIELD_LAMBDA_TOTAL:
        return lambda_field(n.particles.points);
      case FIELD_VELOCITY:
        return vector_field(s->velocities);
      case FIELD_MEAN_VELOCITY:
      case FIELD_CORRECTION_RATE:
        return place_field(s->other);
      case FIELD_SHEAR_PUSH: /* where phases differ with masses */
        return s->phase ? numbered_field(s->other) : place_field(s->other);
      case FIELD_CURL_SIZE:
        return rank_field_of(curl_sizes(), 1, 1);
      case FIELD_MISSING:
        return rank_field_of(missing(), 1, 1);
      case FIELD_DEVIATOR:
        return rank_field_of(s->deviators, PBF_DEVIATOR_DIM, PBF_DEVIATOR_DIM);
      case FIELD_CROWDING: /* with the starts, which have taken the state's place */
        return numbered_field(s->points);
      case FIELD_VISCOUS_CHANGE:
        return vector_field(changes);
      default:
        return place_field(n.particles.points);
    }
  }

  /* Places that nothing has moved since, or that nothing will read, stay as they are. */
  void exchange_with_ranks(int fields) {
    if (fields == FIELD_POSITION) {
      if (!moves_later || (place.last && !reads_places_later())) return;
      moves_later = false;
    }
    const int second = fields & (fields - 1);
    const rank_field none = {nullptr, 0, 0};
    const rank_field first = field_of(fields & -fields), other = second ? field_of(second) : none;
    if (in_two_parts) {
      on_edges beside(s);
      status = exchange_on_ranks(s, first, other);
    } else {
      status = exchange_on_ranks(s, first, other);
    }
  }

  /* From here on the solve's stages work on the particles that other ranks hold, and exchange them,
   * while they work on the others. Times of stages want one after another. */
  void part_edges() {
    const rank_state &r = s->ranks;
    in_two_parts = has_ranks(s) && r.count > 1 && r.inner_first < r.inner_last && !r.careful &&
                   !s->schedule.runs[PBF_STAGE_TORQUE] && !s->schedule.checks_convergence &&
                   !s->activity && !s->clock.begin;
    turn = 0;
    if (in_two_parts) status = record(r.inner_done, s->stream);
    if (in_two_parts && status == PBF_OK) status = record(r.edges_done[1], s->stream);
  }

  void join_edges() {
    if (!in_two_parts) return;
    in_two_parts = false;
    status = record(s->ranks.edges_done[0], s->ranks.edges);
    if (status == PBF_OK) status = await(s->stream, s->ranks.edges_done[0]);
  }

  static pbf_status record(cudaEvent_t event, cudaStream_t stream) {
    return pbf_cuda_check(cudaEventRecord(event, stream), "cudaEventRecord");
  }
  static pbf_status await(cudaStream_t stream, cudaEvent_t event) {
    return pbf_cuda_check(cudaStreamWaitEvent(stream, event, 0), "cudaStreamWaitEvent");
  }

  /* Calls launches(n) for all that the stage works on, in one part or more. Edges read what the
   * stage before has made of all, and of other ranks; the rest reads what it has made here. */
  template <class Launches>
  void in_parts(Launches launches) {
    if (!in_two_parts) return launches(n);
    const rank_state &r = s->ranks;
    neighborhood part = n;
    auto launch_part = [&](uint32_t first, uint32_t last) {
      part.particles.first = first;
      part.particles.count = last;
      if (first < last) launches(part);
    };
    status = await(r.edges, r.inner_done);
    if (status != PBF_OK) return;
    {
      on_edges beside(s);
      launch_part(n.particles.first, r.inner_first);
      launch_part(r.inner_last, n.particles.count);
      status = record(r.edges_done[turn], s->stream);
    }
    turn = 1 - turn;
    if (status == PBF_OK) status = await(s->stream, r.edges_done[turn]);
    if (status != PBF_OK) return;
    launch_part(r.inner_first, r.inner_last);
    status = record(r.inner_done, s->stream);
  }
};

}  // namespace

#endif
