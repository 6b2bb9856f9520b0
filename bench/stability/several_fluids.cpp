/* Two fluids in one solver, which this library does not have: cases 20 and 21. Who asks for them,
 * as a later header or a scene file could, must be told. */
#include <cstring>
#include <fstream>

#include "core/error.h"
#include "stability/cases.h"
#include "stability/fluid.h"

namespace bench::stability {
namespace {

// pbf_params of a later library, whose next field asks for something.
struct LaterParams {
  pbf_params known;
  double ratio[2];
};

void ask_in_parameters(Record &record, double first, double second) {
  Start start = tank({0.2, 0.2, 0.2}, {0.2, 0.1, 0.2});
  Trial trial(record, "present", start);
  LaterParams later;
  std::memset(&later, 0, sizeof later);
  later.known = start.params;
  later.known.struct_size = sizeof later;
  later.ratio[0] = first;
  later.ratio[1] = second;
  const uint64_t before = trial.hash();
  const pbf_status status = pbf_set_params(trial.solver(), &later.known);
  record.refusal("pbf_set_params with a field that this library does not know", status,
                 "this library knows", trial.hash() == before);
  trial.run(10, 1);
}

void ask_in_scene(Record &record, const std::string &key, double value) {
  const std::string path = record.folder() + "/two-fluids.json";
  std::ofstream(path)
      << "{\"version\": 1, \"description\": \"d\", \"purpose\": \"p\", \"steps\": 1, "
         "\"dimension\": 3, \"params\": {}, \"blocks\": [{\"shape\": \"box\", "
         "\"min\": [0, 0, 0], \"max\": [1, 1, 1], \""
      << key << "\": " << value << "}]}\n";
  SceneOptions options;
  options.name = path;
  nlohmann::json entry = {{"call", "a scene whose block has a " + key},
                          {"status", "PBF_OK"},
                          {"sentence", ""},
                          {"names", key},
                          {"unchanged", true}};
  try {
    load_scene(options);
  } catch (const Error &error) {
    entry["status"] = "refused";
    entry["sentence"] = error.what();
  }
  record.append("refusals", entry);
}

}  // namespace

void mass_ratio(Record &record) {
  ask_in_parameters(record, 1000, 1);
  ask_in_parameters(record, 1, 1000);
  ask_in_scene(record, "mass", 1000);
}

void density_ratio(Record &record) {
  ask_in_parameters(record, 1000, 1);
  ask_in_scene(record, "density", 1000);
}

}  // namespace bench::stability
