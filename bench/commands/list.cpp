/* pbf-bench list: scenes, backends, devices, and why one can't serve. */
#include <cstdio>

#include "commands/commands.h"
#include "core/error.h"
#include "core/solver.h"
#include "core/table.h"
#include "scene/scene.h"

namespace bench {
namespace {

std::string scene_table() {
  Table table({"scene", "dim", "particles", "steps", "what it shows"});
  table.align_right(1, 3);
  for (const std::string &name : scene_names()) {
    SceneOptions options;
    options.name = name;
    try {
      const Scene scene = load_scene(options);
      table.add({name, std::to_string(scene.dimension), std::to_string(count_particles(scene)),
                 std::to_string(scene.lead_in_steps + scene.steps), scene.description});
    } catch (const Error &error) {
      table.add({name, "–", "–", "–", error.what()});
    }
  }
  return table.text();
}

std::string backend_table() {
  Table table({"backend", "serves", "device", "build", "why not"});
  for (const pbf_backend_info &backend : list_backends({}, nullptr)) {
    table.add({backend.name, backend.available ? "yes" : "no", backend.device_name,
               backend.build_id, backend.available ? "" : backend.reason});
  }
  return table.text();
}

int list() {
  std::printf("%s\n%s", scene_table().c_str(), backend_table().c_str());
  return exit_ok;
}

}  // namespace

std::pair<CLI::App *, Command> add_list(CLI::App &app) {
  return {app.add_subcommand("list", "Scenes, backends, devices, and why one can't serve"), list};
}

}  // namespace bench
