/* What a caller can do wrong: cases 22, 23, 26. Each call is recorded with what the library said.
 */
#include <cmath>
#include <functional>
#include <limits>

#include "scene/params.h"
#include "stability/cases.h"
#include "stability/fluid.h"

namespace bench::stability {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
const double not_numbers[] = {std::nan(""), infinity, -infinity};

unsigned components_of(FieldType type) {
  return type == FieldType::vector ? 3 : type == FieldType::walls ? 6 : 1;
}

bool is_real(FieldType type) {
  return type == FieldType::number || type == FieldType::vector || type == FieldType::walls;
}

double &component(pbf_params &params, const Field &field, unsigned index) {
  return reinterpret_cast<double *>(reinterpret_cast<char *>(&params) + field.offset)[index];
}

std::string indexed(const std::string &name, unsigned index, unsigned count) {
  return count > 1 ? name + "[" + std::to_string(index) + "]" : name;
}

// The parameters that act in this scene: the others are not looked at.
void use_everything(pbf_params &params) {
  params.scorr_k = 1e-3;
  params.spacing = spacing;
}

void try_params(Record &record, Trial &trial, double value) {
  for (const Field &field : param_fields()) {
    if (!is_real(field.type)) continue;
    for (unsigned i = 0; i < components_of(field.type); ++i) {
      pbf_params params = trial.params();
      component(params, field, i) = value;
      const uint64_t before = trial.hash();
      const pbf_status status = pbf_set_params(trial.solver(), &params);
      record.refusal("pbf_set_params", status, indexed(field.name, i, components_of(field.type)),
                     trial.hash() == before);
    }
  }
}

void try_particles(Record &record, Trial &trial, double value) {
  pbf_solver *solver = trial.solver();
  const std::vector<double> good = {0.1, 0.1, 0.1, 0.15, 0.1, 0.1};
  for (unsigned i = 0; i < good.size(); ++i) {
    std::vector<double> bad = good;
    bad[i] = value;
    const Bytes fine = trial.scalars(good), wrong = trial.scalars(bad);
    const auto at = [&](const char *name, unsigned first) {
      return std::string(name) + "[" + std::to_string(first + i / 3) + "][" +
             std::to_string(i % 3) + "]";
    };
    const uint64_t before = trial.hash();
    const auto refused = [&](const char *call, pbf_status status, const std::string &names) {
      record.refusal(call, status, names, trial.hash() == before);
    };
    refused("pbf_add_particles", pbf_add_particles(solver, 2, wrong.data(), nullptr, nullptr),
            at("positions", 0));
    refused("pbf_add_particles", pbf_add_particles(solver, 2, fine.data(), wrong.data(), nullptr),
            at("velocities", 0));
    refused("pbf_set_positions", pbf_set_positions(solver, 3, 2, wrong.data()), at("positions", 3));
    refused("pbf_set_velocities", pbf_set_velocities(solver, 3, 2, wrong.data()),
            at("velocities", 3));
  }
}

void try_collider(Record &record, Trial &trial, double value) {
  struct Field {
    const char *name;
    unsigned count;
    double *(*of)(pbf_collider &);
  };
  const Field fields[] = {
      {"position", 3, [](pbf_collider &c) { return c.position; }},
      {"orientation", 4, [](pbf_collider &c) { return c.orientation; }},
      {"velocity", 3, [](pbf_collider &c) { return c.velocity; }},
      {"angular_velocity", 3, [](pbf_collider &c) { return c.angular_velocity; }},
      {"axis", 3, [](pbf_collider &c) { return c.axis; }},
      {"half_extents", 3, [](pbf_collider &c) { return c.half_extents; }},
      {"radius", 1, [](pbf_collider &c) { return &c.radius; }},
      {"half_length", 1, [](pbf_collider &c) { return &c.half_length; }},
  };
  for (const Field &field : fields) {
    for (unsigned i = 0; i < field.count; ++i) {
      pbf_collider pair[2];
      for (pbf_collider &c : pair) must(pbf_collider_init(&c, sizeof c, PBF_COLLIDER_CAPSULE));
      field.of(pair[1])[i] = value;
      const uint64_t before = trial.hash();
      const pbf_status status = pbf_set_colliders(trial.solver(), 2, pair);
      record.refusal("pbf_set_colliders", status, std::string("colliders[1].") + field.name,
                     trial.hash() == before);
    }
  }
}

// Denormal lengths and times mean nothing; a denormal coordinate or velocity is as good as 0.
void try_denormals(Record &record, Trial &trial) {
  const double tiny = record.options().precision == PBF_FLOAT64 ? 5e-310 : 1e-40;
  const char *const lengths[] = {"smoothing_radius", "time_step"};
  for (const char *name : lengths) {
    for (const Field &field : param_fields()) {
      if (std::string(field.name) != name) continue;
      pbf_params params = trial.params();
      component(params, field, 0) = tiny;
      const uint64_t before = trial.hash();
      const pbf_status status = pbf_set_params(trial.solver(), &params);
      record.refusal("pbf_set_params", status, name, trial.hash() == before);
    }
  }
  const uint32_t count = trial.count();
  const Bytes slow = trial.scalars(std::vector<double>(size_t{3} * count, tiny));
  record.call("pbf_set_velocities of denormals",
              pbf_set_velocities(trial.solver(), 0, count, slow.data()));
  const Bytes corner = trial.scalars({tiny, tiny, tiny});
  record.call("pbf_set_positions of denormals",
              pbf_set_positions(trial.solver(), 0, 1, corner.data()));
}

}  // namespace

void bad_numbers(Record &record) {
  Start start = tank({0.3, 0.3, 0.3}, {0.3, 0.15, 0.3});
  start.capacity = 500;
  use_everything(start.params);
  Trial trial(record, "state", start);
  for (const double value : not_numbers) {
    try_params(record, trial, value);
    try_particles(record, trial, value);
    try_collider(record, trial, value);
  }
  try_denormals(record, trial);
  trial.run(30, 3);
}

void bad_domains(Record &record) {
  struct Wrong {
    const char *names;
    std::function<void(pbf_params &)> edit;
  };
  const std::vector<Wrong> wrongs = {
      {"smoothing_radius", [](pbf_params &p) { p.smoothing_radius = 0; }},
      {"smoothing_radius", [](pbf_params &p) { p.smoothing_radius = -0.1; }},
      {"spacing", [](pbf_params &p) { p.spacing = p.smoothing_radius; }},
      {"spacing",
       [](pbf_params &p) {
         p.smoothing_radius = 1e6;
         p.spacing = 1;
       }},
      {"time_step", [](pbf_params &p) { p.time_step = 0; }},
      {"time_step", [](pbf_params &p) { p.time_step = -1; }},
      {"domain_max[0]", [](pbf_params &p) { p.domain_max[0] = p.domain_min[0]; }},
      {"domain_max[1]", [](pbf_params &p) { p.domain_max[1] = -1; }},
      {"domain_m",
       [](pbf_params &p) {
         p.domain_min[2] = -1e308;
         p.domain_max[2] = 1e308;
       }},
      {"domain_m",
       [](pbf_params &p) {
         p.domain_min[2] = -3e38;
         p.domain_max[2] = 3e38;
       }},
      {"iterations", [](pbf_params &p) { p.iterations = 0; }},
      {"collide", [](pbf_params &p) { p.collide = 0; }},
  };
  Start start = tank({0.3, 0.3, 0.3}, {0.3, 0.15, 0.3});
  Trial trial(record, "state", start);
  for (const Wrong &wrong : wrongs) {
    pbf_params params = start.params;
    wrong.edit(params);
    const uint64_t before = trial.hash();
    record.refusal("pbf_set_params", pbf_set_params(trial.solver(), &params), wrong.names,
                   trial.hash() == before);
    const pbf_desc desc = desc_for(record, 3, 8, 0);
    pbf_solver *solver = nullptr;
    const pbf_status status = pbf_create(&desc, &params, &solver);
    record.refusal("pbf_create", status, wrong.names, solver == nullptr);
    pbf_destroy(solver);
  }
  // Large, but not too large for its numbers: most of it is empty.
  Start vast = start;
  vast.params.domain_max[0] = vast.params.domain_max[2] = 2000;
  Trial(record, "vast", vast).run(30, 3);
  trial.run(30, 3);
}

void above_capacity(Record &record) {
  Start start = tank({0.3, 0.3, 0.3}, {0.3, 0.15, 0.3});
  Trial trial(record, "full", start);
  trial.run(10, 1);
  const uint64_t before = trial.hash();
  const Bytes one = trial.scalars({0.15, 0.25, 0.15});
  const pbf_status status = pbf_add_particles(trial.solver(), 1, one.data(), nullptr, nullptr);
  record.refusal("pbf_add_particles", status, std::to_string(start.particles.count),
                 trial.hash() == before);
  trial.run(30, 3);
}

}  // namespace bench::stability
