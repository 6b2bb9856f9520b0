#include "pareto/results.h"

#include <filesystem>
#include <fstream>
#include <map>

#include "core/error.h"
#include "core/output_file.h"
#include "pareto/analysis.h"

namespace bench {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

const char *const tool_name = "pbf-bench pareto";

json outcome_json(const Outcome &outcome) {
  if (!outcome.judged()) return nullptr;
  json text = {{"commit", outcome.commit}};
  if (!outcome.reason.empty()) {
    text["reason"] = outcome.reason;
    return text;
  }
  text["errors"] = outcome.errors;
  text["start"] = outcome.start;
  if (!outcome.reasons.empty()) text["reasons"] = outcome.reasons;
  text["state"] = outcome.state;
  text["seconds"] = outcome.seconds;
  return text;
}

Outcome outcome_of(const json &text) {
  Outcome outcome;
  outcome.commit = text.value("commit", "");
  outcome.reason = text.value("reason", "");
  if (!outcome.reason.empty()) return outcome;
  text.at("errors").get_to(outcome.errors);
  text.at("start").get_to(outcome.start);
  if (text.contains("reasons")) text.at("reasons").get_to(outcome.reasons);
  text.at("state").get_to(outcome.state);
  text.at("seconds").get_to(outcome.seconds);
  return outcome;
}

json point_json(const Study &study, const Point &point) {
  json settings = json::object();
  for (const Choice &choice : point.choices) settings[choice.name] = choice.value;
  json text = {{"key", point.key},
               {"family", study.sweep.families[point.family].name},
               {"label", point.label},
               {"backend", point.solver.backend},
               {"precision", point.solver.precision == PBF_FLOAT64 ? "f64" : "f32"},
               {"settings", settings},
               {"time_step", point.scene.params.time_step},
               {"iterations", point.scene.params.iterations},
               {"steps", point.scene.steps},
               {"outcome", outcome_json(point.outcome)}};
  if (!point.outcome.seconds.empty()) text["seconds_per_simulated"] = median_cost(point);
  return text;
}

json context_json(const Study &study) {
  const Machine machine = this_machine();
  const Scene &scene = study.plan.scene;
  json context = {
      {"commit", machine.commit},
      {"cpu_model", machine.cpu},
      {"num_cpus", machine.cpus},
      {"system", machine.system},
      {"compiler", machine.compiler},
      {"scene", scene.name},
      {"particles", count_particles(scene)},
      {"dimension", scene.dimension},
      {"steps", scene.steps},
      {"time_step", scene.params.time_step},
      {"simulated", scene.steps * scene.params.time_step},
      {"repetitions", study.repetitions},
      {"clock", study.cpu_time ? "cpu" : "wall"},
      {"frames", study.frames},
      {"sweep", study.sweep.description},
      {"baseline", study.sweep.families[study.sweep.baseline].name},
      {"subject", study.sweep.families[study.sweep.subject].name},
  };
  for (const auto &[backend, build] : study.builds) {
    context["device_" + backend] = build.device;
    context["build_" + backend] = build.build_id;
  }
  return context;
}

json errors_json(const Study &study) {
  json errors = json::array();
  for (const ErrorFigure &error : study.sweep.errors) {
    errors.push_back({{"figure", error.figure}, {"title", error.title}});
  }
  return errors;
}

json study_json(const Study &study) {
  json points = json::array();
  for (const Point &point : study.plan.points) points.push_back(point_json(study, point));
  return {{"tool", tool_name},
          {"version", 1},
          {"context", context_json(study)},
          {"errors", errors_json(study)},
          {"analysis", analysis_json(study)},
          {"points", points}};
}

json read_results(const std::string &path) {
  std::ifstream file(path, std::ios::binary);
  json text = json::parse(file, nullptr, false);
  if (!text.is_object() || text.value("tool", json()) != tool_name ||
      text.value("version", json()) != 1 || !text.contains("points")) {
    throw Error(exit_usage,
                path + " holds something else than the results of a sweep; name another file");
  }
  return text;
}

}  // namespace

size_t resume(const std::string &path, Study &study) {
  if (!fs::exists(path)) return 0;
  const json text = read_results(path);
  std::map<std::string, Outcome> known;
  try {
    for (const json &point : text.at("points")) {
      if (point.at("outcome").is_null()) continue;
      known[point.at("key").get<std::string>()] = outcome_of(point.at("outcome"));
    }
  } catch (const json::exception &error) {
    throw Error(exit_usage, path + " is damaged: " + error.what() + "; name another file");
  }
  size_t fit = 0;
  std::map<std::string, bool> used;
  for (Point &point : study.plan.points) {
    const auto found = known.find(point.key);
    if (found == known.end()) continue;
    point.outcome = found->second;
    if (!used[point.key]) ++fit;
    used[point.key] = true;
  }
  return known.size() - fit;
}

void write_results(const Study &study, const std::string &path) {
  const fs::path folder = fs::path(path).parent_path();
  std::error_code failed;
  if (!folder.empty()) fs::create_directories(folder, failed);
  write_file(path, study_json(study).dump(1) + '\n');
}

}  // namespace bench
