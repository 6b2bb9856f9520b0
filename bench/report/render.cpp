#include "report/render.h"

#include <filesystem>

#include "core/error.h"
#include "core/output_file.h"

namespace bench {

void render_page(const std::string &name, const std::string &text,
                 const kainjow::mustache::data &values, const std::string &path) {
  kainjow::mustache::mustache page(text);
  const std::string rendered = page.render(values);
  if (!page.is_valid()) throw Error(exit_failure, name + ": " + page.error_message());
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  std::error_code failed;
  if (!folder.empty()) std::filesystem::create_directories(folder, failed);
  write_file(path, rendered);
}

}  // namespace bench
