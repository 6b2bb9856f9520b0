#include "pareto/sweep.h"

#include <algorithm>
#include <set>

#include "core/near.h"
#include "core/resources.h"
#include "scene/params.h"
#include "scene/schema.h"

namespace bench {
namespace {

using nlohmann::json;
using Pointer = json::json_pointer;

constexpr size_t most_candidates = 10000;

// One set of physical parameters for the whole sweep: only then do its errors compare.
const std::set<std::string> physical = {
    "spacing",    "particle_volume", "gravity",       "attraction",     "attraction_center",
    "domain_min", "domain_max",      "wall_velocity", "wall_amplitude", "wall_frequency",
    "wall_phase", "vorticity",       "viscosity"};

std::vector<std::string> known_names() {
  std::vector<std::string> names = sweep_names();
  for (const Field &field : param_fields()) names.push_back(field.name);
  return names;
}

void check_name(const Document &document, const Pointer &where, const std::string &name) {
  if (name == "time_step") {
    throw document.error({where,
                          "the sweep keeps the scene's simulated time; divide_time_step takes "
                          "shorter steps, and more of them"});
  }
  if (name == "smoothing_radius") {
    throw document.error({where,
                          "the sweep keeps the particles' spacing; support takes h as a multiple "
                          "of it"});
  }
  if (physical.count(name) > 0) {
    throw document.error({where, "\"" + name +
                                     "\" is part of what is simulated, and must be one for the "
                                     "whole sweep; --set changes it for all"});
  }
  const std::vector<std::string> known = known_names();
  if (std::find(known.begin(), known.end(), name) == known.end()) {
    throw document.error(
        {where, "there is no parameter \"" + name + "\"" + did_you_mean(name, known)});
  }
}

bool is_count(const json &value, uint64_t most) {
  return value.is_number_unsigned() && value.get<uint64_t>() >= 1 && value.get<uint64_t>() <= most;
}

bool is_support(const json &value) {
  return value.is_number() && value.get<double>() > 1 && value.get<double>() <= 8;
}

// Those values that no scene has; the scene's schema judges the others.
void check_value(const Document &document, const Pointer &where, const std::string &name,
                 const json &value) {
  std::string wanted;
  if (name == "backend" && !(value.is_string() && value != "")) wanted = "a backend's name";
  if (name == "precision" && value != "f32" && value != "f64") wanted = "\"f32\" or \"f64\"";
  if (name == "threads" && !is_count(value, 65536)) wanted = "an integer, 1 … 65536";
  if (name == "divide_time_step" && !is_count(value, 1000)) wanted = "an integer, 1 … 1000";
  if (name == "support" && !is_support(value)) wanted = "a number above 1, up to 8";
  if (wanted.empty()) return;
  throw document.error({where, "the value is " + value.dump() + "; wanted: " + wanted});
}

class Reader {
 public:
  Reader(const Document &document, Sweep &sweep) : document_(document), sweep_(sweep) {}

  void read(const std::string &scene) {
    Schema(sweep_schema_text()).check(document_);
    sweep_.description = document_.value.at("description");
    read_errors(scene);
    const json &families = document_.value.at("families");
    for (size_t i = 0; i < families.size(); ++i) read_family(families[i], Pointer("/families") / i);
    sweep_.baseline = family_of("baseline");
    sweep_.subject = family_of("subject");
  }

 private:
  void read_errors(const std::string &scene) {
    for (const json &error : document_.value.at("errors")) {
      const json scenes = error.value("scenes", json::array({scene}));
      if (std::find(scenes.begin(), scenes.end(), scene) == scenes.end()) continue;
      sweep_.errors.push_back({error.at("figure"), error.at("title"), error.at("explains")});
    }
    if (sweep_.errors.empty()) {
      throw document_.error({Pointer("/errors"), "none is for the scene " + scene});
    }
  }

  size_t family_of(const char *key) const {
    const auto name = document_.value.at(key).get<std::string>();
    std::vector<std::string> known;
    for (const Family &family : sweep_.families) known.push_back(family.name);
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end()) {
      throw document_.error({Pointer("/" + std::string(key)),
                             "there is no family \"" + name + "\"" + did_you_mean(name, known)});
    }
    return static_cast<size_t>(found - known.begin());
  }

  void read_family(const json &family, const Pointer &where) {
    const std::string name = family.at("name");
    for (const Family &other : sweep_.families) {
      if (other.name != name) continue;
      throw document_.error({where / "name", "the family \"" + name + "\" stands twice"});
    }
    sweep_.families.push_back({name, family.at("title")});
    std::vector<Choice> set;
    const json chosen = family.value("set", json::object());
    for (const auto &[key, value] : chosen.items()) {
      set.push_back(choice(key, value, where / "set" / key, where / "set" / key, false));
    }
    const json products = family.value("vary", json::array({json::object()}));
    for (size_t i = 0; i < products.size(); ++i) {
      read_product(products[i], where / "vary" / i, set);
    }
  }

  Choice choice(const std::string &name, const json &value, const Pointer &key,
                const Pointer &where, bool varied) const {
    check_name(document_, key, name);
    check_value(document_, where, name, value);
    return {name, value, document_.place(where), varied};
  }

  // Every combination of one value of each list.
  void read_product(const json &product, const Pointer &where, const std::vector<Choice> &set) {
    std::vector<std::vector<Choice>> combinations = {set};
    for (const auto &[name, values] : product.items()) {
      refuse_twice(name, where, set);
      std::vector<std::vector<Choice>> more;
      for (const std::vector<Choice> &start : combinations) {
        for (size_t i = 0; i < values.size(); ++i) {
          more.push_back(start);
          more.back().push_back(choice(name, values[i], where / name, where / name / i, true));
        }
      }
      combinations = std::move(more);
      check_size(combinations.size());
    }
    for (std::vector<Choice> &choices : combinations) {
      sweep_.candidates.push_back({sweep_.families.size() - 1, std::move(choices)});
    }
    check_size(sweep_.candidates.size());
  }

  void refuse_twice(const std::string &name, const Pointer &where,
                    const std::vector<Choice> &set) const {
    for (const Choice &other : set) {
      if (other.name != name) continue;
      throw document_.error({where / name, "\"" + name + "\" is set for the whole family already"});
    }
  }

  void check_size(size_t count) const {
    if (count <= most_candidates) return;
    throw document_.error(
        {Pointer("/families"),
         "there are more than " + std::to_string(most_candidates) + " points; take fewer values"});
  }

  const Document &document_;
  Sweep &sweep_;
};

}  // namespace

const std::vector<std::string> &sweep_names() {
  static const std::vector<std::string> names = {"backend", "precision", "threads",
                                                 "divide_time_step", "support"};
  return names;
}

Sweep read_sweep(const Document &document, const std::string &scene) {
  Sweep sweep;
  Reader(document, sweep).read(scene);
  return sweep;
}

Sweep default_sweep(const std::string &scene) {
  return read_sweep(Document("default.json", default_sweep_text()), scene);
}

Sweep quick_sweep(const std::string &scene) {
  return read_sweep(Document("quick.json", quick_sweep_text()), scene);
}

}  // namespace bench
