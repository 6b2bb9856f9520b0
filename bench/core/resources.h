/* Text files of the source tree that are built into the program, and folders that lie beside it. */
#ifndef PBF_BENCH_RESOURCES_H
#define PBF_BENCH_RESOURCES_H

#include <string>

namespace bench {

std::string scene_schema_text();
std::string sweep_schema_text();
std::string default_sweep_text();
std::string quick_sweep_text();
std::string report_page_text();
std::string ablation_page_text();
std::string stability_page_text();
std::string pareto_page_text();

// The installed folder of this name, or `source`, from the program's folder, when it has not been
// installed: an edited file is then the one that counts.
std::string data_folder(const std::string &name, const std::string &source);

}  // namespace bench

#endif
