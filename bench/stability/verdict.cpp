/* The judge's report, read and shown. */
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "core/checker.h"
#include "core/error.h"
#include "core/process.h"
#include "core/table.h"
#include "stability/suite.h"

namespace bench::stability {
namespace {

namespace fs = std::filesystem;

Verdict verdict_of(const nlohmann::json &entry) {
  Verdict verdict;
  verdict.number = entry.at("case");
  verdict.backend = entry.at("backend");
  verdict.outcome = entry.at("verdict");
  verdict.reason = entry.at("reason");
  verdict.note = entry.at("note");
  verdict.seconds = entry.at("seconds");
  for (const auto &figure : entry.at("figures")) {
    verdict.figures.push_back(
        {figure.at("name"), figure.at("shown"), figure.at("bound_shown"), figure.at("holds")});
  }
  for (const auto &picture : entry.at("pictures")) {
    verdict.pictures.emplace_back(picture.at("file"), picture.at("caption"));
  }
  return verdict;
}

std::string summary(const Verdict &verdict) {
  if (verdict.outcome == "absent" || verdict.outcome == "unavailable") return verdict.outcome;
  std::string mark = verdict.outcome == "holds" ? "ok" : "FAILS";
  if (verdict.figures.empty() || !verdict.reason.empty()) return mark;
  return mark + "  " + verdict.figures[0].value + " " + verdict.figures[0].bound;
}

}  // namespace

Judgement judge(const SuiteOptions &options) {
  const std::string &folder = options.dump;
  const std::string path = folder + "/verdicts.json";
  std::error_code failed;
  fs::remove(path, failed);
  std::vector<std::string> words = {
      python_program(), "-B", checker_folder() + "/pbf-check", "stability", folder, "--json", path,
      "--silent"};
  for (const int number : options.cases)
    words.insert(words.end(), {"--case", std::to_string(number)});
  for (const std::string &backend : options.backends)
    words.insert(words.end(), {"--backend", backend});
  const Ended ended = run_program(words);
  std::ifstream file(path);
  if (!file) {
    throw Error(exit_failure, "the dumps in " + folder + " could not be judged" +
                                  (ended.reason.empty() ? "" : ": " + ended.reason) +
                                  "; pbf-check stability " + folder +
                                  " judges them where Python has NumPy and SciPy");
  }
  Judgement judgement;
  judgement.text.assign(std::istreambuf_iterator<char>(file), {});
  const nlohmann::json report = nlohmann::json::parse(judgement.text);
  for (const auto &entry : report.at("verdicts")) {
    judgement.verdicts.push_back(verdict_of(entry));
  }
  return judgement;
}

std::vector<std::string> backends_of(const Judgement &judgement) {
  std::vector<std::string> names;
  for (const Verdict &verdict : judgement.verdicts) {
    if (std::find(names.begin(), names.end(), verdict.backend) == names.end()) {
      names.push_back(verdict.backend);
    }
  }
  return names;
}

std::string verdict_table(const Judgement &judgement) {
  std::vector<std::string> header = {"", "case", "passes when"};
  const std::vector<std::string> backends = backends_of(judgement);
  header.insert(header.end(), backends.begin(), backends.end());
  Table table(header);
  table.align_right(0, 0);
  std::string failures;
  for (const Case &entry : all_cases()) {
    std::map<std::string, const Verdict *> row;
    for (const Verdict &verdict : judgement.verdicts) {
      if (verdict.number == entry.number) row[verdict.backend] = &verdict;
    }
    if (row.empty()) continue;
    std::vector<std::string> cells = {std::to_string(entry.number), entry.name, entry.passes};
    for (const std::string &backend : backends) {
      cells.push_back(row.count(backend) ? summary(*row[backend]) : "");
    }
    table.add(cells);
    for (const auto &[backend, verdict] : row) {
      if (verdict->outcome != "fails") continue;
      failures += "\n" + std::to_string(entry.number) + " " + entry.name + ", " + backend + "\n";
      if (!verdict->reason.empty()) failures += "    " + verdict->reason + "\n";
      for (const Figure &figure : verdict->figures) {
        if (!figure.holds) {
          failures += "    " + figure.name + ": " + figure.value + ", bound " + figure.bound + "\n";
        }
      }
    }
  }
  return table.text() + failures;
}

}  // namespace bench::stability
