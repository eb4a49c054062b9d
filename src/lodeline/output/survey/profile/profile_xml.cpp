#include <fmt/format.h>
#include <libxml/parser.h>
#include <libxml/tree.h>

#include <cstring>
#include <fstream>
#include <functional>
#include <memory>
#include <string_view>

#include "lodeline/diagnostics.h"
#include "lodeline/output/survey/profile/profile_rows.h"
#include "lodeline/output/survey/profile/profile_time.h"
#include "lodeline/util/csv_fields.h"

namespace lodeline {
namespace {

using Document = std::unique_ptr<xmlDoc, decltype(&xmlFreeDoc)>;

bool isNamed(const xmlNode* node, const char* name) {
  return node->type == XML_ELEMENT_NODE && std::strcmp(reinterpret_cast<const char*>(node->name), name) == 0;
}

std::string textOf(xmlChar* text) {
  const std::string result = text == nullptr ? "" : reinterpret_cast<const char*>(text);
  xmlFree(text);
  return std::string(csv::trimmed(result));
}

std::string attribute(xmlNode* node, const char* name) {
  return textOf(xmlGetProp(node, reinterpret_cast<const xmlChar*>(name)));
}

/// Calls `use` for every element of that name below a node, in the order of the file.
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

/// Number at the start of a text, such as "12.3 m".
std::optional<double> leadingNumber(std::string_view text) {
  double number = 0.0;
  if (!csv::parse(text.substr(0, text.find(' ')), &number)) return std::nullopt;
  return number;
}

void add(std::optional<double> time_s, std::optional<double> depth, int dive, const xmlNode* node,
         ProfileRows* profile) {
  if (time_s && depth) profile->rows.push_back({*time_s, *depth, dive, static_cast<int>(xmlGetLineNo(node))});
}

/// Subsurface: `<sample time='1:30 min' depth='3.05 m'/>`, metres always; the dive computers of
/// a dive one after another.
void readSubsurface(xmlNode* root, ProfileRows* profile) {
  profile->metres_per_unit = 1.0;
  int dive = 0;
  forEach(root, "dive", [&](xmlNode* element) {
    ++dive;
    forEach(element, "sample", [&](xmlNode* sample) {
      const std::string time = attribute(sample, "time");
      add(parseProfileTime(time.substr(0, time.find(' '))), leadingNumber(attribute(sample, "depth")), dive,
          sample, profile);
    });
  });
}

/// UDDF: `<waypoint><depth>3.0</depth><divetime>90</divetime></waypoint>`, metres and seconds always.
void readUddf(xmlNode* root, ProfileRows* profile) {
  profile->metres_per_unit = 1.0;
  int dive = 0;
  forEach(root, "samples", [&](xmlNode* samples) {
    ++dive;
    forEach(samples, "waypoint", [&](xmlNode* waypoint) {
      add(leadingNumber(childText(waypoint, "divetime")), leadingNumber(childText(waypoint, "depth")), dive,
          waypoint, profile);
    });
  });
}

/// UDCF: `<delta>30</delta><d>0</d><d>2.74</d>` or `<t>30</t><d>2.74</d>`, seconds; `<units>` for all.
void readUdcf(xmlNode* root, ProfileRows* profile) {
  constexpr double kMetresPerFoot = 0.3048;
  profile->metres_per_unit = childText(root, "units") == "Imperial" ? kMetresPerFoot : 1.0;
  int dive = 0;
  forEach(root, "samples", [&](xmlNode* samples) {
    ++dive;
    double time_s = 0.0, step_s = 0.0;
    for (xmlNode* child = samples->children; child != nullptr; child = child->next) {
      const auto number = [&] { return leadingNumber(textOf(xmlNodeGetContent(child))); };
      if (isNamed(child, "delta")) step_s = number().value_or(0.0);
      if (isNamed(child, "t")) time_s = number().value_or(time_s);
      if (!isNamed(child, "d")) continue;
      add(time_s, number(), dive, child, profile);
      time_s += step_s;
    }
  });
}

bool beginsAsXml(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string head(512, '\0');
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<size_t>(stream.gcount()));
  // Skips a byte order mark, and the zero bytes of UTF-16.
  for (const char c : head) {
    if (c == '<') return true;
    if (std::strchr(" \t\r\n\xEF\xBB\xBF\xFF\xFE", c) == nullptr) return false;
  }
  return false;
}

}  // namespace

std::optional<ProfileRows> readProfileXml(const std::filesystem::path& file) {
  if (!beginsAsXml(file)) return std::nullopt;
  const Document document(
      xmlReadFile(file.c_str(), nullptr, XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING),
      xmlFreeDoc);
  xmlNode* root = document == nullptr ? nullptr : xmlDocGetRootElement(document.get());
  if (root == nullptr) throw InputError(file.string() + ": damaged XML; export the dive anew");
  ProfileRows profile;
  if (isNamed(root, "divelog") || isNamed(root, "dives")) {
    readSubsurface(root, &profile);
  } else if (isNamed(root, "uddf")) {
    readUddf(root, &profile);
  } else if (isNamed(root, "profile")) {
    readUdcf(root, &profile);
  } else {
    throw InputError(
        fmt::format("{}: XML whose root is <{}>, which is no dive log that is read here (Subsurface, UDDF, "
                    "UDCF); import it into "
                    "Subsurface and export the dive as 'CSV dive profile'",
                    file.string(), reinterpret_cast<const char*>(root->name)));
  }
  if (profile.rows.empty()) throw InputError(file.string() + ": a dive log without a depth profile");
  return profile;
}

}  // namespace lodeline
