#include <fmt/format.h>
#include <libxml/parser.h>
#include <libxml/tree.h>

#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <string_view>

#include "lodeline/diagnostics.h"
#include "lodeline/io/dives/profile_rows.h"
#include "lodeline/io/dives/profile_time.h"
#include "lodeline/io/tables/cells.h"
#include "lodeline/io/tables/units.h"

namespace lodeline {
namespace {

using Document = std::unique_ptr<xmlDoc, decltype(&xmlFreeDoc)>;

bool isNamed(const xmlNode* node, const char* name) {
  return node->type == XML_ELEMENT_NODE && std::strcmp(reinterpret_cast<const char*>(node->name), name) == 0;
}

std::string textOf(xmlChar* text) {
  std::string result = text == nullptr ? "" : reinterpret_cast<const char*>(text);
  xmlFree(text);
  const size_t begin = result.find_first_not_of(" \t\r\n");
  if (begin == std::string::npos) return "";
  return result.substr(begin, result.find_last_not_of(" \t\r\n") + 1 - begin);
}

std::string attribute(xmlNode* node, const char* name) {
  return textOf(xmlGetProp(node, reinterpret_cast<const xmlChar*>(name)));
}

/// Calls `use` for every element of that name below a node, in the order of the
/// file.
void forEach(xmlNode* node, const char* name, const std::function<void(xmlNode*)>& use) {
  for (xmlNode* child = node->children; child != nullptr; child = child->next) {
    if (child->type != XML_ELEMENT_NODE) continue;
    if (isNamed(child, name)) {
      use(child);
    } else {
      forEach(child, name, use);
    }
  }
}

/// Text of a child element; empty without it.
std::string childText(xmlNode* node, const char* name) {
  for (xmlNode* child = node->children; child != nullptr; child = child->next) {
    if (isNamed(child, name)) return textOf(xmlNodeGetContent(child));
  }
  return "";
}

/// Text of the first element of that name at any depth below a node.
std::string textBelow(xmlNode* node, const char* name) {
  std::string text;
  forEach(node, name, [&](xmlNode* found) {
    if (text.empty()) text = textOf(xmlNodeGetContent(found));
  });
  return text;
}

/// Number at the start of a text, such as "12.3 m" or "12,3".
std::optional<double> leadingNumber(std::string_view text) {
  return numberFrom(text.substr(0, text.find(' ')));
}

/// A date and a time of day as "YYYY-MM-DD HH:MM:SS"; empty where the date is
/// none.
std::string startOf(const std::string& date, const std::string& time) {
  return profileStart(time.empty() ? date : date + " " + time);
}

/// Builds the rows of one log.
class Log {
 public:
  Log(std::string name, double metres_per_unit) : name_(std::move(name)) {
    rows_.metres_per_unit = metres_per_unit;
    rows_.has_stated_dives = true;
  }

  void beginDive(const std::string& number, const std::string& start) {
    rows_.dives.push_back({number, start});
  }

  void add(std::optional<double> time_s, std::optional<double> depth, const xmlNode* node) {
    if (!time_s || !depth || !std::isfinite(*time_s) || !std::isfinite(*depth)) return;
    rows_.rows.push_back({*time_s, *depth, static_cast<int>(rows_.dives.size()), lineOf(node)});
  }

  /// Throws for a unit that is not that of the format.
  [[noreturn]] void refuseUnit(const std::string& unit, const xmlNode* node) const {
    throw InputError(
        fmt::format("{}:{}: depths in '{}', which is no known unit here", name_, lineOf(node), unit));
  }

  ProfileRows take() {
    if (rows_.rows.empty()) throw InputError(name_ + ": a dive log without a depth profile");
    return std::move(rows_);
  }

 private:
  static int lineOf(const xmlNode* node) { return static_cast<int>(xmlGetLineNo(node)); }

  std::string name_;
  ProfileRows rows_;
};

/// Subsurface: `<sample time='1:30 min' depth='3.05 m'/>`; the dive computers
/// of a dive one after another.
ProfileRows readSubsurface(xmlNode* root, const std::string& name) {
  Log log(name, 1.0);
  forEach(root, "dive", [&](xmlNode* dive) {
    log.beginDive(attribute(dive, "number"), startOf(attribute(dive, "date"), attribute(dive, "time")));
    forEach(dive, "sample", [&](xmlNode* sample) {
      const std::string time = attribute(sample, "time"), depth = attribute(sample, "depth");
      const size_t blank = depth.find(' ');
      const std::string unit = blank == std::string::npos ? "m" : depth.substr(blank + 1);
      const std::optional<double> metres = unitFactor(Quantity::Length, unit);
      if (!metres) log.refuseUnit(unit, sample);
      const std::optional<double> number = leadingNumber(depth);
      log.add(parseProfileTime(time.substr(0, time.find(' '))),
              number ? std::optional(*number * *metres) : std::nullopt, sample);
    });
  });
  return log.take();
}

/// UDDF: `<waypoint><depth>3.0</depth><divetime>90</divetime></waypoint>`,
/// metres and seconds always.
ProfileRows readUddf(xmlNode* root, const std::string& name) {
  Log log(name, 1.0);
  forEach(root, "dive", [&](xmlNode* dive) {
    log.beginDive(textBelow(dive, "divenumber"), startOf(textBelow(dive, "datetime"), ""));
    forEach(dive, "waypoint", [&](xmlNode* waypoint) {
      log.add(leadingNumber(childText(waypoint, "divetime")), leadingNumber(childText(waypoint, "depth")),
              waypoint);
    });
  });
  return log.take();
}

std::string udcfStart(xmlNode* dive) {
  const std::string year = textBelow(dive, "year"), month = textBelow(dive, "month"),
                    day = textBelow(dive, "day");
  const std::string hour = textBelow(dive, "hour"), minute = textBelow(dive, "minute");
  if (year.empty() || month.empty() || day.empty()) return "";
  return startOf(fmt::format("{}-{:0>2}-{:0>2}", year, month, day),
                 hour.empty() ? "" : fmt::format("{:0>2}:{:0>2}", hour, minute.empty() ? "0" : minute));
}

/// UDCF: `<delta>30</delta><d>0</d><d>2.74</d>` or `<t>30</t><d>2.74</d>`,
/// seconds; `<units>` for all.
ProfileRows readUdcf(xmlNode* root, const std::string& name) {
  constexpr double kMetresPerFoot = 0.3048;
  const std::string units = childText(root, "units");
  Log log(name, units == "Imperial" ? kMetresPerFoot : 1.0);
  constexpr std::array kKnown = {"", "Metric", "metric", "SI", "Imperial"};
  if (std::find(kKnown.begin(), kKnown.end(), units) == kKnown.end()) log.refuseUnit(units, root);
  forEach(root, "dive", [&](xmlNode* dive) {
    log.beginDive(textBelow(dive, "divenumber"), udcfStart(dive));
    forEach(dive, "samples", [&](xmlNode* samples) {
      double time_s = 0.0, step_s = 0.0;
      for (xmlNode* child = samples->children; child != nullptr; child = child->next) {
        const auto number = [&] { return leadingNumber(textOf(xmlNodeGetContent(child))); };
        if (isNamed(child, "delta")) step_s = number().value_or(0.0);
        if (isNamed(child, "t")) time_s = number().value_or(time_s);
        if (!isNamed(child, "d")) continue;
        log.add(time_s, number(), child);
        time_s += step_s;
      }
    });
  });
  return log.take();
}

/// Suunto Dive Manager:
/// `<SUUNTO><MSG><SAMPLE><SAMPLETIME>20</SAMPLETIME><DEPTH>4,5</DEPTH>`,
/// seconds and metres.
ProfileRows readSuuntoManager(xmlNode* root, const std::string& name) {
  Log log(name, 1.0);
  forEach(root, "MSG", [&](xmlNode* dive) {
    log.beginDive(childText(dive, "DIVENUMBER"), startOf(childText(dive, "DATE"), childText(dive, "TIME")));
    forEach(dive, "SAMPLE", [&](xmlNode* sample) {
      // Marks of the diver have no reading.
      if (!childText(sample, "BOOKMARK").empty()) return;
      log.add(leadingNumber(childText(sample, "SAMPLETIME")), leadingNumber(childText(sample, "DEPTH")),
              sample);
    });
  });
  return log.take();
}

/// Suunto DM4 and DM5:
/// `<Dive><DiveSamples><Dive.Sample><Depth>1.48</Depth><Time>0</Time>`, metres
/// and seconds.
ProfileRows readSuuntoDm(xmlNode* root, const std::string& name) {
  Log log(name, 1.0);
  const auto read = [&](xmlNode* dive) {
    log.beginDive(childText(dive, "DiveNumber"), startOf(childText(dive, "StartTime"), ""));
    forEach(dive, "Dive.Sample", [&](xmlNode* sample) {
      log.add(leadingNumber(childText(sample, "Time")), leadingNumber(childText(sample, "Depth")), sample);
    });
  };
  if (isNamed(root, "Dive")) {
    read(root);
  } else {
    forEach(root, "Dive", read);
  }
  return log.take();
}

struct Format {
  const char* root;
  ProfileRows (*read)(xmlNode* root, const std::string& name);
};
constexpr Format kFormats[] = {
    {"divelog", readSubsurface},  {"dives", readSubsurface},     {"uddf", readUddf},
    {"profile", readUdcf},        {"SUUNTO", readSuuntoManager}, {"Dive", readSuuntoDm},
    {"ArrayOfDive", readSuuntoDm}};

bool beginsAsXml(std::string_view text) {
  constexpr size_t kHead = 512;
  // Skips a byte order mark, and the zero bytes of UTF-16.
  for (const char c : text.substr(0, kHead)) {
    if (c == '<') return true;
    if (std::strchr(" \t\r\n\xEF\xBB\xBF\xFF\xFE", c) == nullptr) return false;
  }
  return false;
}

/// Whether a document declares entities. Logs of dives have none, and their
/// expansion can exceed any memory.
bool declaresEntities(const xmlDoc* document) {
  for (const xmlDtd* dtd : {document->intSubset, document->extSubset}) {
    const xmlNode* declaration = dtd == nullptr ? nullptr : dtd->children;
    for (; declaration != nullptr; declaration = declaration->next) {
      if (declaration->type == XML_ENTITY_DECL) return true;
    }
  }
  return false;
}

struct FirstError {
  int line = 0;
  std::string message;
};

/// Parses without network, external files and entities.
Document parse(const std::string& text, const std::string& name) {
  FirstError first;
  const std::unique_ptr<xmlParserCtxt, decltype(&xmlFreeParserCtxt)> parser(xmlNewParserCtxt(),
                                                                            xmlFreeParserCtxt);
  if (parser == nullptr) throw InputError(name + ": no memory to read its XML");
  parser->_private = &first;
  parser->sax->serror = [](void* data, auto* error) {
    auto* kept = static_cast<FirstError*>(static_cast<xmlParserCtxt*>(data)->_private);
    if (error->level < XML_ERR_ERROR || kept->line != 0 || error->message == nullptr) return;
    *kept = {error->line, error->message};
    kept->message.erase(kept->message.find_last_not_of(" \r\n") + 1);
  };
  Document document(xmlCtxtReadMemory(parser.get(), text.data(), static_cast<int>(text.size()), nullptr,
                                      nullptr, XML_PARSE_NONET),
                    xmlFreeDoc);
  if (document == nullptr || xmlDocGetRootElement(document.get()) == nullptr) {
    throw InputError(
        fmt::format("{}:{}: damaged XML ({}); export the dive anew", name, first.line, first.message));
  }
  if (declaresEntities(document.get()))
    throw InputError(name +
                     ": XML that declares entities, as no dive log "
                     "does; export the dive anew");
  return document;
}

}  // namespace

std::optional<ProfileRows> readProfileXml(const std::string& text, const std::string& name) {
  if (!beginsAsXml(text)) return std::nullopt;
  const Document document = parse(text, name);
  xmlNode* root = xmlDocGetRootElement(document.get());
  for (const Format& format : kFormats) {
    if (isNamed(root, format.root)) return format.read(root, name);
  }
  throw InputError(
      fmt::format("{}: XML whose root is <{}>, which is no dive "
                  "log that is read here (Subsurface, UDDF, UDCF, "
                  "Suunto); import it into Subsurface and export "
                  "the dive as 'CSV dive profile'",
                  name, reinterpret_cast<const char*>(root->name)));
}

}  // namespace lodeline
