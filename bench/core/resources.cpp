#include "core/resources.h"

#include <filesystem>

#include "core/process.h"

namespace bench {

extern const unsigned char scene_schema_json[];
extern const unsigned long scene_schema_json_size;
extern const unsigned char ablation_page_html[];
extern const unsigned long ablation_page_html_size;
extern const unsigned char sweep_schema_json[];
extern const unsigned long sweep_schema_json_size;
extern const unsigned char default_sweep_json[];
extern const unsigned long default_sweep_json_size;
extern const unsigned char quick_sweep_json[];
extern const unsigned long quick_sweep_json_size;
extern const unsigned char report_page_html[];
extern const unsigned long report_page_html_size;
extern const unsigned char stability_page_html[];
extern const unsigned long stability_page_html_size;
extern const unsigned char pareto_page_html[];
extern const unsigned long pareto_page_html_size;

std::string scene_schema_text() {
  return std::string(scene_schema_json, scene_schema_json + scene_schema_json_size);
}

std::string sweep_schema_text() {
  return std::string(sweep_schema_json, sweep_schema_json + sweep_schema_json_size);
}

std::string default_sweep_text() {
  return std::string(default_sweep_json, default_sweep_json + default_sweep_json_size);
}

std::string quick_sweep_text() {
  return std::string(quick_sweep_json, quick_sweep_json + quick_sweep_json_size);
}

std::string report_page_text() {
  return std::string(report_page_html, report_page_html + report_page_html_size);
}

std::string ablation_page_text() {
  return std::string(ablation_page_html, ablation_page_html + ablation_page_html_size);
}

std::string stability_page_text() {
  return std::string(stability_page_html, stability_page_html + stability_page_html_size);
}

std::string pareto_page_text() {
  return std::string(pareto_page_html, pareto_page_html + pareto_page_html_size);
}

std::string data_folder(const std::string &name, const std::string &source) {
  const std::filesystem::path program = this_program();
  const std::filesystem::path installed = program.parent_path() / PBF_BENCH_DATA_FROM_BIN / name;
  std::error_code failed;
  const bool is_installed = std::filesystem::is_directory(installed, failed);
  const std::filesystem::path found = is_installed ? installed : program.parent_path() / source;
  return found.lexically_normal().string();
}

}  // namespace bench
