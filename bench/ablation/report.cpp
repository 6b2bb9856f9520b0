/* The rows of an ablation as a table, JSON and a page. */
#include <algorithm>
#include <cstdio>

#include <kainjow/mustache.hpp>
#include <nlohmann/json.hpp>

#include "ablation/ablation.h"
#include "core/machine.h"
#include "core/output_file.h"
#include "core/resources.h"
#include "core/table.h"
#include "report/render.h"
#include "speedup/speedup.h"

namespace bench {

namespace {

using nlohmann::json;

bool ran(const AblationRow &row) { return !row.ms_per_step.empty(); }

std::string dash_or(bool known, const std::string &text) { return known ? text : "–"; }

double least(const std::vector<double> &values) {
  return *std::min_element(values.begin(), values.end());
}

double most(const std::vector<double> &values) {
  return *std::max_element(values.begin(), values.end());
}

// The middle half of the values.
std::pair<double, double> middle_half(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {values[values.size() / 4], values[values.size() - 1 - values.size() / 4]};
}

std::string percent_more(double ratio) {
  char text[32];
  std::snprintf(text, sizeof text, "%+.1f %%", 100 * (ratio - 1));
  return text;
}

std::string spread_of(const std::vector<double> &ratios) {
  const auto [low, high] = middle_half(ratios);
  return percent_more(low) + " … " + percent_more(high);
}

uint32_t stage_runs(const pbf_plan &plan) {
  uint32_t runs = 0;
  for (uint32_t k = 0; k < plan.stage_count; ++k) runs += plan.stages[k].runs_per_step;
  return runs;
}

uint32_t launches(const pbf_plan &plan) {
  uint32_t sum = 0;
  for (uint32_t k = 0; k < plan.stage_count; ++k) sum += plan.stages[k].launches_per_step;
  return sum;
}

// Launches where there are any, a device's; else runs of stages.
std::string work_text(const pbf_plan &plan) {
  const uint32_t n = launches(plan);
  return n > 0 ? std::to_string(n) + " launches" : std::to_string(stage_runs(plan));
}

std::string error_text(const Facts &facts) {
  return dash_or(facts.has_stats != 0, rounded(100 * facts.stats.density_error_mean, 3) + " %");
}

using Cells = std::vector<std::string>;

Cells without_times(const AblationRow &row, size_t columns) {
  Cells cells(columns, "–");
  cells.front() = row.name;
  cells.back() = row.reason.empty() ? "interrupted" : row.reason;
  return cells;
}

const Cells variant_header = {"the minimal plan", "ms/step",       "more",          "middle half",
                              "bytes/particle",   "stages a step", "density error", ""};

Cells variant_cells(const AblationRow &row) {
  if (!ran(row)) return without_times(row, variant_header.size());
  return {row.name,
          rounded(median_of(row.ms_per_step), 4),
          percent_more(median_of(row.ratios)),
          spread_of(row.ratios),
          rounded(row.facts.plan.bytes_per_particle, 4),
          work_text(row.facts.plan),
          error_text(row.facts),
          ""};
}

const Cells build_header = {"build",         "ms/step",    "more", "middle half",
                            "least ms/step", "more bytes", "bits", "which it is"};

Cells build_cells(const AblationRow &row, const AblationRow &first) {
  if (!ran(row) || !ran(first)) return without_times(row, build_header.size());
  const auto bytes = static_cast<long long>(row.facts.plan.bytes - first.facts.plan.bytes);
  return {row.name,
          rounded(median_of(row.ms_per_step), 4),
          percent_more(median_of(row.ratios)),
          spread_of(row.ratios),
          rounded(least(row.ms_per_step), 4),
          std::to_string(bytes),
          row.facts.hash == first.facts.hash ? "the same" : "others",
          row.facts.info.build_id};
}

std::string table_of(const Cells &header, const std::vector<Cells> &rows) {
  Table table(header);
  table.align_right(1, header.size() - 2);
  for (const Cells &row : rows) table.add(row);
  return table.text();
}

std::vector<Cells> variant_rows(const Ablation &ablation) {
  std::vector<Cells> rows;
  for (const AblationRow &row : ablation.variants) rows.push_back(variant_cells(row));
  return rows;
}

std::vector<Cells> build_rows(const Ablation &ablation) {
  std::vector<Cells> rows;
  for (const AblationRow &row : ablation.builds)
    rows.push_back(build_cells(row, ablation.builds.front()));
  return rows;
}

json stages_json(const pbf_plan &plan) {
  json stages = json::array();
  for (uint32_t k = 0; k < plan.stage_count; ++k) {
    stages.push_back({{"name", plan.stages[k].name},
                      {"runs_per_step", plan.stages[k].runs_per_step},
                      {"launches_per_step", plan.stages[k].launches_per_step}});
  }
  return stages;
}

json row_json(const AblationRow &row) {
  json out = {{"name", row.name}};
  if (!ran(row)) {
    out["reason"] = row.reason;
    return out;
  }
  const Facts &facts = row.facts;
  char hash[20];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(facts.hash));
  const auto [low, high] = middle_half(row.ratios);
  out.update({{"ms_per_step", row.ms_per_step},
              {"ms_per_step_median", median_of(row.ms_per_step)},
              {"ms_per_step_least", least(row.ms_per_step)},
              {"ms_per_step_most", most(row.ms_per_step)},
              {"ratio_median", median_of(row.ratios)},
              {"ratio_middle_half", {low, high}},
              {"bytes", facts.plan.bytes},
              {"bytes_per_particle", facts.plan.bytes_per_particle},
              {"variant", facts.plan.variant},
              {"stages", stages_json(facts.plan)},
              {"build_id", facts.info.build_id},
              {"state", hash}});
  if (facts.has_stats) {
    out["density_error_mean"] = facts.stats.density_error_mean;
    out["density_error_max"] = facts.stats.density_error_max;
  }
  return out;
}

json rows_json(const std::vector<AblationRow> &rows) {
  json out = json::array();
  for (const AblationRow &row : rows) out.push_back(row_json(row));
  return out;
}

const AblationRow &first_of(const Ablation &ablation) {
  return ablation.variants.empty() ? ablation.builds.front() : ablation.variants.front();
}

kainjow::mustache::data page_table(const Cells &header, const std::vector<Cells> &rows) {
  using kainjow::mustache::data;
  data lines{data::type::list}, table;
  std::vector<Cells> all = rows;
  all.insert(all.begin(), header);
  for (const Cells &row : all) {
    data line, cells{data::type::list};
    for (const std::string &text : row) {
      data cell;
      cell.set("text", text);
      cells << cell;
    }
    line.set("cells", cells);
    lines << line;
  }
  table.set("lines", lines);
  return table;
}

std::string machine_text(const Ablation &ablation) {
  const Machine machine = this_machine();
  const pbf_info &info = first_of(ablation).facts.info;
  return std::string(info.backend) + " on " + info.device_name + ", " +
         std::to_string(info.threads) + " threads; " + machine.cpu + " with " +
         std::to_string(machine.cpus) + " CPUs; " + info.build_id + "; commit " + machine.commit;
}

}  // namespace

std::string ablation_table(const Ablation &ablation) {
  if (!ablation.variants.empty()) return table_of(variant_header, variant_rows(ablation));
  return table_of(build_header, build_rows(ablation));
}

void write_ablation_json(const Ablation &ablation, const std::string &path) {
  const Machine machine = this_machine();
  const pbf_info &info = first_of(ablation).facts.info;
  const json out = {{"scene", ablation.scene.name},
                    {"particles", count_particles(ablation.scene)},
                    {"steps_a_round", ablation.scene.steps},
                    {"backend", info.backend},
                    {"device", info.device_name},
                    {"threads", info.threads},
                    {"time", ablation.cpu_time ? "CPU" : "clock"},
                    {"cpu_model", machine.cpu},
                    {"cpus", machine.cpus},
                    {"commit", machine.commit},
                    {"features", rows_json(ablation.variants)},
                    {"builds", rows_json(ablation.builds)}};
  write_file(path, out.dump(2) + '\n');
}

void write_ablation_page(const Ablation &ablation, const std::string &path) {
  kainjow::mustache::data data;
  data.set("scene", ablation.scene.name);
  data.set("particles", counted(count_particles(ablation.scene)));
  data.set("steps", std::to_string(ablation.scene.steps));
  data.set("machine", machine_text(ablation));
  const bool builds = ablation.variants.empty();
  data.set("title", builds ? "What features cost those who do not use them" : "What features cost");
  data.set("table", builds ? page_table(build_header, build_rows(ablation))
                           : page_table(variant_header, variant_rows(ablation)));
  render_page("page.html", ablation_page_text(), data, path);
}

}  // namespace bench
