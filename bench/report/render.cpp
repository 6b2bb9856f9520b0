#include "report/render.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "core/error.h"

namespace bench {

void render_page(const std::string &name, const std::string &text,
                 const kainjow::mustache::data &values, const std::string &path) {
  kainjow::mustache::mustache page(text);
  const std::string rendered = page.render(values);
  if (!page.is_valid()) throw Error(exit_failure, name + ": " + page.error_message());
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  std::error_code failed;
  if (!folder.empty()) std::filesystem::create_directories(folder, failed);
  std::ofstream file(path, std::ios::binary);
  file << rendered;
  file.close();
  if (!file) throw Error(exit_failure, path + " can't be written: " + std::strerror(errno));
}

}  // namespace bench
