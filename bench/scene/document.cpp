#include "scene/document.h"

#include <algorithm>
#include <set>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "core/content.h"

namespace bench {
namespace {

using nlohmann::json;

constexpr size_t max_depth = 16;
constexpr uintmax_t max_file_size = 16u << 20;

std::string place_of(const std::string &text, size_t offset) {
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(offset, text.size()));
  const auto line = 1 + std::count(text.begin(), end, '\n');
  const auto start = std::find(std::make_reverse_iterator(end), text.rend(), '\n').base();
  return std::to_string(line) + ":" + std::to_string(1 + std::distance(start, end));
}

// Follows the parser through the text and notes where each value begins.
class PlaceRecorder : public json::json_sax_t {
 public:
  PlaceRecorder(const std::string &name, const std::string &text, std::istringstream &stream)
      : name_(name), text_(text), stream_(stream) {}

  bool null() override { return value(); }
  bool boolean(bool) override { return value(); }
  bool number_integer(number_integer_t) override { return value(); }
  bool number_unsigned(number_unsigned_t) override { return value(); }
  bool number_float(number_float_t, const string_t &) override { return value(); }
  bool string(string_t &) override { return value(); }
  bool binary(binary_t &) override { return value(); }
  bool start_object(std::size_t) override { return open(false); }
  bool start_array(std::size_t) override { return open(true); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t &name) override {
    Level &level = levels_.back();
    level.key = name;
    if (!level.keys.insert(name).second) {
      throw Error(exit_usage, name_ + ":" + place_of(text_, token_start()) + ": the key \"" + name +
                                  "\" stands twice in one object");
    }
    consumed_ = here();
    return true;
  }

  bool parse_error(std::size_t position, const std::string &,
                   const nlohmann::detail::exception &error) override {
    std::string reason = error.what();
    const auto colon = reason.find(": ");
    if (colon != std::string::npos) reason = reason.substr(colon + 2);
    throw Error(exit_usage, name_ + ":" + place_of(text_, position > 0 ? position - 1 : 0) +
                                ": this is not JSON: " + reason);
  }

  std::map<std::string, std::string> places;

 private:
  struct Level {
    bool is_array;
    size_t index = 0;
    std::string key;
    std::set<std::string> keys;
  };

  size_t here() const { return text_.size() - static_cast<size_t>(stream_.rdbuf()->in_avail()); }

  // The token that was read last: the first character after the token before it that separates
  // nothing.
  size_t token_start() const {
    const size_t start = text_.find_first_not_of(" \t\r\n:,", consumed_);
    return start == std::string::npos ? text_.size() : start;
  }

  json::json_pointer pointer() const {
    json::json_pointer path;
    for (const Level &level : levels_) {
      path /= level.is_array ? std::to_string(level.index) : level.key;
    }
    return path;
  }

  void note() {
    places[pointer().to_string()] = place_of(text_, token_start());
    consumed_ = here();
  }

  void next() {
    if (!levels_.empty() && levels_.back().is_array) ++levels_.back().index;
  }

  bool value() {
    note();
    next();
    return true;
  }

  bool open(bool is_array) {
    if (levels_.size() == max_depth) {
      throw Error(exit_usage, name_ + ":" + place_of(text_, token_start()) +
                                  ": nested deeper than " + std::to_string(max_depth) +
                                  " levels; a scene needs 6");
    }
    note();
    levels_.push_back({is_array, 0, {}, {}});
    return true;
  }

  bool close() {
    levels_.pop_back();
    consumed_ = here();
    next();
    return true;
  }

  const std::string &name_;
  const std::string &text_;
  std::istringstream &stream_;
  std::vector<Level> levels_;
  size_t consumed_ = 0;
};

}  // namespace

Document::Document(const std::string &name, const std::string &text) : name_(name) {
  std::istringstream stream(text);
  PlaceRecorder recorder(name_, text, stream);
  json::sax_parse(stream, &recorder);
  places_ = std::move(recorder.places);
  value = json::parse(text);
}

void Document::override_value(const json::json_pointer &pointer, const json &new_value,
                              const std::string &origin) {
  value[pointer] = new_value;
  // What stood below the old value stands nowhere now.
  const std::string below = pointer.to_string() + "/";
  for (auto place = places_.lower_bound(below);
       place != places_.end() && place->first.rfind(below, 0) == 0;) {
    place = places_.erase(place);
  }
  origins_[pointer.to_string()] = origin;
}

std::string Document::place(json::json_pointer pointer) const {
  for (;; pointer = pointer.parent_pointer()) {
    const std::string text = pointer.to_string();
    if (const auto origin = origins_.find(text); origin != origins_.end()) return origin->second;
    if (const auto place = places_.find(text); place != places_.end()) {
      return name_ + ":" + place->second;
    }
    if (pointer.empty()) return name_;
  }
}

Error Document::error(const ValueError &error) const {
  const std::string path = error.pointer.to_string();
  return Error(exit_usage,
               place(error.pointer) + ": " + (path.empty() ? "" : path + ": ") + error.sentence);
}

Document read_document(const std::string &path) {
  std::string text;
  try {
    text = content_of(path, max_file_size);
  } catch (const std::runtime_error &error) {
    throw Error(exit_usage, error.what());
  }
  return Document(path, text);
}

}  // namespace bench
