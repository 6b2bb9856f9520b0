/* Fills stability.html with the verdicts. */
#include <fstream>
#include <iterator>

#include <kainjow/mustache.hpp>

#include "core/machine.h"
#include "core/resources.h"
#include "report/base64.h"
#include "report/render.h"
#include "stability/suite.h"

namespace bench::stability {
namespace {

using kainjow::mustache::data;

const Verdict *find(const Judgement &judgement, int number, const std::string &backend) {
  for (const Verdict &v : judgement.verdicts) {
    if (v.number == number && v.backend == backend) return &v;
  }
  return nullptr;
}

data figures_of(const Verdict &verdict) {
  data list{data::type::list};
  for (const Figure &figure : verdict.figures) {
    data row;
    row.set("name", figure.name);
    row.set("value", figure.value);
    row.set("bound", figure.bound);
    row.set("fails", !figure.holds);
    list << row;
  }
  return list;
}

data cell_of(const Verdict *verdict) {
  data cell;
  cell.set("outcome", verdict ? verdict->outcome : "none");
  if (!verdict) return cell;
  cell.set("backend", verdict->backend);
  cell.set("reason", verdict->reason);
  cell.set("note", verdict->note);
  cell.set("figures", figures_of(*verdict));
  const bool figure = !verdict->figures.empty() && verdict->reason.empty();
  cell.set("value", figure ? verdict->figures[0].value : verdict->outcome);
  cell.set("bound", figure ? verdict->figures[0].bound : "");
  return cell;
}

std::string contents(const std::string &path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Of the backends that agree, one picture is enough.
data pictures_of(const Judgement &judgement, int number) {
  data list{data::type::list};
  const Verdict *chosen = nullptr;
  for (const Verdict &v : judgement.verdicts) {
    if (v.number != number || v.pictures.empty()) continue;
    if (!chosen || v.outcome == "fails") chosen = &v;
  }
  if (!chosen) return list;
  for (const auto &[file, caption] : chosen->pictures) {
    data picture;
    picture.set("png", base64(contents(file)));
    picture.set("caption", caption + " (" + chosen->backend + ")");
    list << picture;
  }
  return list;
}

data rows_of(const Judgement &judgement, const std::vector<std::string> &backends) {
  data rows{data::type::list};
  for (const Case &entry : all_cases()) {
    data row, cells{data::type::list};
    bool any = false;
    for (const std::string &backend : backends) {
      const Verdict *verdict = find(judgement, entry.number, backend);
      any = any || verdict;
      cells << cell_of(verdict);
    }
    if (!any) continue;
    row.set("number", std::to_string(entry.number));
    row.set("name", entry.name);
    row.set("passes", entry.passes);
    row.set("cells", cells);
    row.set("pictures", pictures_of(judgement, entry.number));
    rows << row;
  }
  return rows;
}

std::string headline(const Judgement &judgement) {
  size_t held = 0, judged = 0;
  for (const Verdict &v : judgement.verdicts) {
    held += v.outcome == "holds";
    judged += v.outcome == "holds" || v.outcome == "fails";
  }
  return std::to_string(held) + " of " + std::to_string(judged) + " verdicts hold";
}

data page_data(const Judgement &judgement) {
  const std::vector<std::string> backends = backends_of(judgement);
  const Machine machine = this_machine();
  data page, names{data::type::list};
  for (const std::string &backend : backends) {
    data name;
    name.set("name", backend);
    names << name;
  }
  page.set("headline", headline(judgement));
  page.set("backends", names);
  page.set("rows", rows_of(judgement, backends));
  page.set("cpu", machine.cpu);
  page.set("system", machine.system);
  page.set("compiler", machine.compiler);
  page.set("commit", machine.commit);
  return page;
}

}  // namespace

void write_verdict_page(const Judgement &judgement, const std::string &path) {
  render_page("page.html", stability_page_text(), page_data(judgement), path);
}

}  // namespace bench::stability
