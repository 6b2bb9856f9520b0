#include "pareto/judge.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>

#include "core/checker.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/process.h"
#include "pareto/digest.h"

namespace bench {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

struct FigureName {
  std::string entry;   // "E1"
  std::string figure;  // "measure.interior.mean_abs"
  std::string over;    // "mean", "largest", "last", or empty: of the whole run
};

FigureName parse(const std::string &text) {
  const size_t dot = text.find('.'), at = text.find('@');
  return {text.substr(0, dot), text.substr(dot + 1, at == std::string::npos ? at : at - dot - 1),
          at == std::string::npos ? "" : text.substr(at + 1)};
}

std::optional<double> number(const json &object, const std::string &key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

double over_frames(const std::vector<double> &values, const std::string &over) {
  if (over == "last") return std::fabs(values.back());
  double sum = 0, largest = 0;
  for (const double value : values) {
    sum += std::fabs(value);
    largest = std::max(largest, std::fabs(value));
  }
  return over == "mean" ? sum / static_cast<double>(values.size()) : largest;
}

void read_figure(const json &entry, const std::string &figure, Outcome &outcome) {
  const FigureName name = parse(figure);
  if (name.over.empty()) {
    const auto value = number(entry.at("figures"), name.figure);
    if (value) outcome.errors[figure] = std::max(*value, 0.0);
    return;
  }
  const json &frames = entry.at("frames");
  if (const auto first = number(frames.at(0), name.figure)) outcome.start[figure] = *first;
  std::vector<double> values;
  for (size_t i = 1; i < frames.size(); ++i) {
    if (const auto value = number(frames[i], name.figure)) values.push_back(*value);
  }
  if (!values.empty()) outcome.errors[figure] = over_frames(values, name.over);
}

std::string first_line(const std::string &text) { return text.substr(0, text.find('\n')); }

std::string last_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

std::string digest_of_sources(const fs::path &folder) {
  std::vector<fs::path> files;
  std::error_code failed;
  for (const auto &entry : fs::directory_iterator(folder, failed)) {
    if (entry.path().extension() == ".py") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  Digest digest;
  for (const fs::path &file : files) digest.add(digest_of_file(file.string()));
  return digest.text();
}

}  // namespace

void read_report(const json &report, const std::vector<ErrorFigure> &errors, Outcome &outcome) {
  for (const ErrorFigure &error : errors) {
    const json &entry = report.at("errors").at(parse(error.figure).entry);
    if (entry.contains("reason")) {
      outcome.reasons[error.figure] = entry.at("reason");
      continue;
    }
    read_figure(entry, error.figure, outcome);
    if (outcome.errors.count(error.figure) == 0) {
      outcome.reasons[error.figure] = "pbf-check gives no such figure for this run";
    }
  }
}

Judge::Judge(const std::string &scratch, const std::vector<ErrorFigure> &errors)
    : scratch_(scratch), errors_(errors) {
  std::string said;
  if (run({"-c", "import numpy, scipy"}, said) != 0) {
    throw Error(exit_failure, "pbf-check, which judges, needs Python with NumPy and SciPy, and " +
                                  python_program() + " does not do: " + last_line(said) +
                                  "; PBF_PYTHON names another one");
  }
  id_ = digest_of_sources(checker_folder() + "/pbfcheck");
  std::set<std::string> keys;
  for (const ErrorFigure &error : errors) keys.insert(parse(error.figure).entry);
  for (const std::string &key : keys) keys_ += (keys_.empty() ? "" : ",") + key;
}

int Judge::run(const std::vector<std::string> &arguments, std::string &said) const {
  std::vector<std::string> words = {python_program()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const std::string errors = scratch_ + "/stderr";
  const Ended ended = run_program(words, errors);
  std::stringstream text;
  text << std::ifstream(errors).rdbuf();
  said = ended.reason.empty() ? text.str() : ended.reason;
  if (!ended.reason.empty()) return 127;
  return ended.signal != 0 ? 128 + ended.signal : ended.code;
}

void Judge::judge(const std::string &dump, Outcome &outcome) const {
  const std::string file = scratch_ + "/report.json";
  std::string said;
  const int code =
      run({"-B", checker_folder() + "/pbf-check", "errors", dump, "--only", keys_, "--json", file},
          said);
  constexpr int bad_dump = 3;
  if (code == bad_dump) {
    outcome.reason = "can't be judged: " + first_line(said);
    return;
  }
  if (interrupted()) return;  // Ctrl-C ends it, too
  if (code != 0) {
    throw Error(exit_failure,
                "pbf-check ended with " + std::to_string(code) + ": " + last_line(said));
  }
  std::ifstream text(file);
  read_report(json::parse(text), errors_, outcome);
}

}  // namespace bench
