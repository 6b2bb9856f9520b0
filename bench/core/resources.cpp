#include "core/resources.h"

namespace bench {

extern const unsigned char scene_schema_json[];
extern const unsigned long scene_schema_json_size;
extern const unsigned char ablation_page_html[];
extern const unsigned long ablation_page_html_size;
extern const unsigned char report_page_html[];
extern const unsigned long report_page_html_size;
extern const unsigned char stability_page_html[];
extern const unsigned long stability_page_html_size;

std::string scene_schema_text() {
  return std::string(scene_schema_json, scene_schema_json + scene_schema_json_size);
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

}  // namespace bench
