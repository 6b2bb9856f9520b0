/* Text files of the source tree that are built into the program. */
#ifndef PBF_BENCH_RESOURCES_H
#define PBF_BENCH_RESOURCES_H

#include <string>

namespace bench {

std::string scene_schema_text();
std::string report_page_text();
std::string ablation_page_text();
std::string stability_page_text();

}  // namespace bench

#endif
