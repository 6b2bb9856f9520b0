/* What was measured of many worlds, as tables and as JSON. */
#include <cstdio>
#include <nlohmann/json.hpp>

#include "ablation/ablation.h"
#include "core/machine.h"
#include "core/output_file.h"
#include "core/table.h"
#include "worlds/worlds.h"

namespace bench {
namespace {

using nlohmann::json;

std::string worlds_number(double value, const char *format) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

// Of the backend's one large world; 0: that has not run.
double rate_of_one_world(const std::vector<WorldsRow> &rows, const std::string &backend) {
  for (const WorldsRow &row : rows)
    if (row.backend == backend && row.way == "one world") return row.particle_steps_per_second();
  return 0;
}

json worlds_context(const Scene &scene) {
  const Machine machine = this_machine();
  return {{"cpu", machine.cpu},           {"cpus", machine.cpus},     {"system", machine.system},
          {"compiler", machine.compiler}, {"commit", machine.commit}, {"scene", scene.name},
          {"steps", scene.steps}};
}

void write_worlds_file(const std::string &path, const json &content) {
  write_file(path, content.dump(1) + "\n");
}

}  // namespace

std::string worlds_table(const std::vector<WorldsRow> &rows) {
  Table table({"backend", "way", "worlds", "particles each", "threads", "ms a step of all",
               "million particle-steps a second", "of one world"});
  table.align_right(2, 7);
  for (const WorldsRow &row : rows) {
    if (row.milliseconds.empty()) {
      table.add({row.backend, row.way, row.reason.empty() ? "interrupted" : row.reason});
      continue;
    }
    const double rate = row.particle_steps_per_second();
    const double whole = rate_of_one_world(rows, row.backend);
    table.add({row.backend, row.way, std::to_string(row.worlds), std::to_string(row.particles),
               std::to_string(row.threads), worlds_number(median_of(row.milliseconds), "%.4g"),
               worlds_number(1e-6 * rate, "%.4g"),
               whole > 0 ? worlds_number(100 * rate / whole, "%.0f %%") : ""});
  }
  return table.text();
}

void write_worlds_json(const Scene &scene, const std::vector<WorldsRow> &rows,
                       const std::string &path) {
  json content = {{"context", worlds_context(scene)}, {"rows", json::array()}};
  for (const WorldsRow &row : rows) {
    content["rows"].push_back({{"backend", row.backend},
                               {"way", row.way},
                               {"device", row.device},
                               {"reason", row.reason},
                               {"worlds", row.worlds},
                               {"particles", row.particles},
                               {"threads", row.threads},
                               {"ms_per_step", row.milliseconds},
                               {"particle_steps_per_second", row.particle_steps_per_second()}});
  }
  write_worlds_file(path, content);
}

std::string startup_table(const std::vector<StartupRow> &rows) {
  Table table({"backend", "particles", "first solver, to its first step, ms", "create, ms",
               "first step, ms", "destroy, ms", "a batch's world: create, ms", "reset, ms"});
  table.align_right(1, 7);
  for (const StartupRow &row : rows) {
    if (!row.reason.empty()) {
      table.add({row.backend, std::to_string(row.particles), row.reason});
      continue;
    }
    std::vector<std::string> cells{row.backend, std::to_string(row.particles)};
    for (const double ms :
         {row.first_ms, row.create_ms, row.step_ms, row.destroy_ms, row.world_ms, row.reset_ms})
      cells.push_back(worlds_number(ms, "%.3g"));
    table.add(cells);
  }
  return table.text();
}

void write_startup_json(const Scene &scene, const std::vector<StartupRow> &rows,
                        const std::string &path) {
  json content = {{"context", worlds_context(scene)}, {"rows", json::array()}};
  for (const StartupRow &row : rows) {
    content["rows"].push_back({{"backend", row.backend},
                               {"device", row.device},
                               {"reason", row.reason},
                               {"particles", row.particles},
                               {"first_ms", row.first_ms},
                               {"create_ms", row.create_ms},
                               {"step_ms", row.step_ms},
                               {"destroy_ms", row.destroy_ms},
                               {"world_ms", row.world_ms},
                               {"reset_ms", row.reset_ms}});
  }
  write_worlds_file(path, content);
}

}  // namespace bench
