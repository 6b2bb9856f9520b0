#include "pareto/plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/error.h"
#include "core/machine.h"
#include "pareto/digest.h"

namespace bench {
namespace {

using nlohmann::json;

const json *chosen(const std::vector<Choice> &choices, const std::string &name) {
  for (const Choice &choice : choices) {
    if (choice.name == name) return &choice.value;
  }
  return nullptr;
}

bool is_parameter(const Choice &choice) {
  const std::vector<std::string> &others = sweep_names();
  return std::find(others.begin(), others.end(), choice.name) == others.end();
}

std::string short_number(const json &value) {
  if (!value.is_number_float()) return value.is_string() ? value.get<std::string>() : value.dump();
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value.get<double>());
  return text;
}

std::string words_of(const Choice &choice) {
  std::string value = short_number(choice.value);
  if (choice.name == "iterations") return value + (value == "1" ? " iteration" : " iterations");
  if (choice.name == "divide_time_step") return value == "1" ? "Δt" : "Δt/" + value;
  if (choice.name == "support") return "h = " + value + " d";
  if (choice.name == "backend" || choice.name == "precision") return value;
  return choice.name + " " + value;
}

// What sets the point apart within its family; iterations and time step first.
std::string label_of(const std::vector<Choice> &choices) {
  const std::vector<std::string> first = {"iterations", "divide_time_step"};
  std::vector<std::string> words;
  for (const std::string &name : first) {
    for (const Choice &choice : choices) {
      if (choice.varied && choice.name == name) words.push_back(words_of(choice));
    }
  }
  for (const Choice &choice : choices) {
    const bool done = std::find(first.begin(), first.end(), choice.name) != first.end();
    if (choice.varied && !done) words.push_back(words_of(choice));
  }
  std::string label;
  for (const std::string &word : words) label += (label.empty() ? "" : ", ") + word;
  return label.empty() ? "as it is" : label;
}

double spacing_of(const pbf_params &params) {
  return params.spacing > 0 ? params.spacing : params.smoothing_radius / 2;
}

void choose_support(pbf_params &params, double support) {
  params.spacing = spacing_of(params);
  params.smoothing_radius = support * params.spacing;
}

// The walls' matter begins at one place for every point. Walls that contribute density keep
// particles half a spacing off; without it their centres reach the bound, which so moves to where
// the centres of the first layer are.
void keep_walls(Scene &scene, const pbf_params &base) {
  pbf_params &params = scene.params;
  const double lent_before = base.wall_density > 0, lent_now = params.wall_density > 0;
  const double inwards = (lent_before - lent_now) * spacing_of(base) / 2;
  for (unsigned axis = 0; axis < scene.dimension; ++axis) {
    params.domain_min[axis] += inwards;
    params.domain_max[axis] -= inwards;
  }
}

uint32_t whole_steps(double steps, const char *what) {
  if (steps < 0.5 || steps > std::numeric_limits<uint32_t>::max()) {
    throw Error(exit_usage, std::string(what) + ": these are " + std::to_string(steps) +
                                " steps; wanted: 1 … 4294967295");
  }
  return static_cast<uint32_t>(std::lround(steps));
}

// A point runs the lead-in, too: all of it is simulated time.
Scene base_scene(const PlanOptions &options) {
  Scene scene = load_scene(options.scene);
  if (options.scene.steps == 0) scene.steps += scene.lead_in_steps;
  scene.lead_in_steps = 0;
  if (options.duration > 0) {
    scene.steps = whole_steps(options.duration / scene.params.time_step, "--duration");
  }
  return scene;
}

class Planner {
 public:
  Planner(const Sweep &sweep, const PlanOptions &options)
      : sweep_(sweep), options_(options), cpu_(this_machine().cpu) {
    plan_.scene = base_scene(options);
    start_ = Digest().add(fill_scene(plan_.scene)).add_objects(plan_.scene).text();
    every_ = std::max(1u, plan_.scene.steps / std::max(1u, options.frames));
  }

  Plan run() {
    for (const Candidate &candidate : sweep_.candidates) {
      if (chosen(candidate.choices, "backend")) {
        plan_.points.push_back(make(candidate, ""));
        continue;
      }
      for (const std::string &backend : options_.backends) {
        plan_.points.push_back(make(candidate, backend));
      }
    }
    return std::move(plan_);
  }

 private:
  Point make(const Candidate &candidate, const std::string &backend) const {
    Point point;
    point.family = candidate.family;
    point.choices = candidate.choices;
    choose_solver(point, backend);
    point.scene = scene_of(candidate.choices);
    if (const json *divide = chosen(candidate.choices, "divide_time_step")) {
      point.divide = divide->get<uint32_t>();
    }
    point.scene.steps =
        whole_steps(static_cast<double>(plan_.scene.steps) * point.divide, "divide_time_step");
    point.scene.params.time_step /= point.divide;
    point.every = every_ * point.divide;
    point.label = label_of(candidate.choices);
    point.work = work_of(point.scene);
    point.key = key_of(point);
    return point;
  }

  void choose_solver(Point &point, const std::string &backend) const {
    point.solver.backend = backend;
    if (const json *name = chosen(point.choices, "backend")) point.solver.backend = *name;
    if (const json *threads = chosen(point.choices, "threads")) point.solver.threads = *threads;
    const json *precision = chosen(point.choices, "precision");
    if (precision && *precision == "f64") point.solver.precision = PBF_FLOAT64;
  }

  Scene scene_of(const std::vector<Choice> &choices) const {
    SceneOptions options = options_.scene;
    for (const Choice &choice : choices) {
      if (is_parameter(choice)) {
        options.overrides.push_back({choice.name, choice.value, choice.origin});
      }
    }
    Scene scene = load_scene(options);
    scene.steps = plan_.scene.steps;
    scene.lead_in_steps = 0;
    keep_walls(scene, plan_.scene.params);
    if (const json *support = chosen(choices, "support")) choose_support(scene.params, *support);
    return scene;
  }

  // A search costs about as much as three iterations, and all of it goes with the neighbours.
  static double work_of(const Scene &scene) {
    const double reach = scene.params.smoothing_radius / spacing_of(scene.params);
    return scene.steps * (3.0 + scene.params.iterations) * std::pow(reach, scene.dimension);
  }

  std::string key_of(const Point &point) const {
    Digest digest;
    digest.add(start_).add(point.scene.params).add(point.scene.steps).add(point.every);
    digest.add(point.solver.backend).add(point.solver.precision).add(point.solver.threads);
    digest.add(build_of(point.solver.backend)).add(cpu_).add(options_.judge);
    for (const ErrorFigure &error : sweep_.errors) digest.add(error.figure);
    if (options_.cpu_time) digest.add("CPU time");
    return digest.text();
  }

  // The build is the plugin's file, bit by bit; build ids alone do not change with every edit.
  static std::map<std::string, std::string> builds_of_backends() {
    std::map<std::string, std::string> builds;
    for (const pbf_backend_info &info : list_backends({}, nullptr)) {
      builds[info.name] +=
          std::string(info.build_id) + info.device_name + digest_of_file(info.path);
    }
    return builds;
  }

  std::string build_of(const std::string &backend) const {
    const auto found = builds_.find(backend);
    return found == builds_.end() ? "" : found->second;
  }

  const Sweep &sweep_;
  const PlanOptions &options_;
  std::string cpu_, start_;
  std::map<std::string, std::string> builds_ = builds_of_backends();
  uint32_t every_ = 1;
  Plan plan_;
};

}  // namespace

Plan make_plan(const Sweep &sweep, const PlanOptions &options) {
  return Planner(sweep, options).run();
}

}  // namespace bench
